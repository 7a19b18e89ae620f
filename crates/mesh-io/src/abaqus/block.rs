//! A keyword with its data lines, as it stands in the file.

use super::keyword::Keyword;
use crate::place::FileLocation;

/// A keyword that is not one of the mesh, with its data lines.
pub(crate) struct Block {
    pub keyword: Keyword,
    pub rows: Vec<(String, FileLocation)>,
}

impl Block {
    /// The name without spaces: CalculiX takes `*ENDSTEP` for `*END STEP`.
    pub fn name(&self) -> String {
        self.keyword.name.replace(' ', "")
    }

    /// True if data lines may be in a file of their own, `INPUT=`; with other keywords that parameter means something else.
    pub fn takes_input(&self) -> bool {
        const NAMES: [&str; 16] = [
            "AMPLITUDE",
            "BOUNDARY",
            "CLOAD",
            "CONTACTPAIR",
            "DENSITY",
            "DLOAD",
            "DSLOAD",
            "ELASTIC",
            "FRICTION",
            "HYPERELASTIC",
            "INITIALCONDITIONS",
            "MULLINSEFFECT",
            "PLASTIC",
            "SURFACEBEHAVIOR",
            "TIE",
            "VISCOELASTIC",
        ];
        NAMES.contains(&self.name().as_str())
    }
}
