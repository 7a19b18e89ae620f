//! Keys and words that scenes once had. An error says what replaces them, instead of that they are unknown.
//!
//! Who renames or removes a key, or a word that a key may have, adds a line here.

/// A key that is no more, or a word that a key may not have any more.
struct Old {
    /// Path of the key without numbers of elements.
    key: &'static str,
    /// The word; `None` if the key itself is no more.
    word: Option<&'static str>,
    message: &'static str,
    remedy: &'static str,
}

const OLD: [Old; 15] = [
    Old {
        key: "contact.normals",
        word: None,
        message: "is no longer a key: normals are the means of the facets around a node, on each side of a sharp edge",
        remedy: "remove it",
    },
    Old {
        key: "contact.smoothing",
        word: None,
        message: "is no longer a key: the weighted gap follows the facets, and slivers have no pressure",
        remedy: "remove it",
    },
    Old {
        key: "contact.constraint",
        word: Some("one-sided"),
        message: "is no longer a constraint: mortar contact keeps the true gap, which needs none",
        remedy: "remove it",
    },
    Old {
        key: "contact.closing",
        word: Some("restore"),
        message: "is no longer a word: it gave back energy by an impulse that knows no other constraints",
        remedy: "write restitution = 1, with which the law of impact keeps the energy of every step of rigid bodies; of deformable ones remove it",
    },
    Old {
        key: "contact.quadrature",
        word: None,
        message: "is no longer a key: mortar integrals have the rule of seven points",
        remedy: "remove it",
    },
    Old {
        key: "contact.nearness",
        word: None,
        message: "is no longer a key: near points at sharp edges weigh more in statics, and not in dynamics",
        remedy: "remove it",
    },
    Old {
        key: "contact.drop_gap_term",
        word: None,
        message: "is no longer a key: the balance of the coordinates has the derivative of the gap, which is zero at the foot",
        remedy: "remove it",
    },
    Old {
        key: "contact.drop_gap_slope",
        word: None,
        message: "is no longer a key: linear equations have the derivative of the gap by the coordinates",
        remedy: "remove it",
    },
    Old {
        key: "contact.enforcement.augmented",
        word: None,
        message: "is no longer a way to enforce gaps: multipliers give the same result by one solution of a step",
        remedy: "remove `enforcement`",
    },
    Old {
        key: "contact.friction.stick",
        word: Some("augmented"),
        message: "is no longer a way to stick: multipliers give the same result by one solution of a step",
        remedy: "write \"multiplier\", and remove `penalty`",
    },
    Old {
        key: "contact.friction.midpoint",
        word: None,
        message: "is no longer a key: springs have the traction of the end of the step, which is the law's also where pressures alternate",
        remedy: "remove it",
    },
    Old {
        key: "contact.friction.slip",
        word: Some("yang"),
        message: "is no longer a measure of the slip",
        remedy: "remove it: \"objective\" counts no rigid motion as slip either",
    },
    Old {
        key: "time.integrator.scheme",
        word: Some("energy-momentum-augmented"),
        message: "is no longer a scheme: elements eliminate the augmented coordinates, which gave the equations of `energy-momentum`",
        remedy: "write \"energy-momentum\"",
    },
    Old {
        key: "stage.integrator.scheme",
        word: Some("energy-momentum-augmented"),
        message: "is no longer a scheme: elements eliminate the augmented coordinates, which gave the equations of `energy-momentum`",
        remedy: "write \"energy-momentum\"",
    },
    Old {
        key: "stage.kind",
        word: Some("static"),
        message: "is no longer a kind: stages have the words of `[scene] kind`",
        remedy: "write \"quasi-static\"",
    },
];

/// Message and remedy for a key that is no more.
pub(crate) fn key(path: &str) -> Option<(&'static str, &'static str)> {
    find(path, None)
}

/// Message and remedy for a word that a key may not have any more.
pub(crate) fn word(path: &str, word: &str) -> Option<(&'static str, &'static str)> {
    find(path, Some(word))
}

fn find(path: &str, word: Option<&str>) -> Option<(&'static str, &'static str)> {
    // `contact[3].normals` is `contact.normals`.
    let path: String = path.split('[').map(|piece| piece.split_once(']').map_or(piece, |(_, rest)| rest)).collect();
    OLD.iter().find(|old| old.key == path && old.word == word).map(|old| (old.message, old.remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_kind_of_a_stage_names_the_new_one() {
        let (_, remedy) = word("stage[2].kind", "static").unwrap();
        assert!(remedy.contains("quasi-static"));
        assert!(word("scene.kind", "static").is_none());
    }

    #[test]
    fn paths_are_compared_without_numbers() {
        assert!(key("contact[12].normals").is_some() && key("contact.normals").is_some());
        assert!(key("contact[1]").is_none() && key("tie[0].normals").is_none() && key("").is_none());
        assert!(word("contact[0].constraint", "one-sided").is_some());
        assert!(word("contact[0].constraint", "standard").is_none() && key("contact[0].constraint").is_none());
    }
}
