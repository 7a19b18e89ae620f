//! Letters as strokes on a small grid, made for this program: legible from 10 pixels on, of any size, without a font file.

/// Heights on the grid: descenders end at 0, the base line is at 2, small letters reach 6, capitals and digits 8.
const BASE: f64 = 2.0;
/// Grid units of a size of one: capitals are 0.72 high.
const UNIT: f64 = 0.12;
/// Room between letters, and the width of a blank, in grid units.
const GAP: f64 = 1.7;
const BLANK: f64 = 2.2;

/// Strokes of the characters from `!` to `~`: strokes are divided by `;`, their points by blanks. A point is a column and a row of the grid;
/// a stroke of one point is a dot.
const GLYPHS: [&str; 94] = [
    "08 04;02",
    "08 06;28 26",
    "12 18;32 38;04 44;06 46",
    "47 38 18 07 06 15 35 44 43 32 12 03;21 29",
    "02 48;07 18 27 16 07;33 44 53 42 33",
    "42 06 07 18 27 26 04 03 12 22 44",
    "08 06",
    "19 07 03 11",
    "09 17 13 01",
    "27 23;06 44;04 46",
    "23 27;05 45",
    "13 12 01",
    "05 35",
    "02",
    "01 49",
    "12 32 43 47 38 18 07 03 12",
    "17 28 22;12 32",
    "07 18 38 47 46 02 42",
    "07 18 38 47 46 35 15;35 44 43 32 12 03",
    "32 38 04 44",
    "48 08 05 35 44 43 32 12 03",
    "47 38 18 07 03 12 32 43 44 35 15 04",
    "08 48 12",
    "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35",
    "03 12 32 43 47 38 18 07 06 15 35 46",
    "05;02",
    "15;13 12 01",
    "47 05 43",
    "04 44;06 46",
    "07 45 03",
    "07 18 38 47 46 24;22",
    "46 26 15 14 23 43;46 43 53 64 67 58 18 07 03 12 52",
    "02 28 42;15 35",
    "02 08 38 47 46 35 05;35 44 43 32 02",
    "47 38 18 07 03 12 32 43",
    "02 08 28 46 44 22 02",
    "48 08 02 42;05 35",
    "48 08 02;05 35",
    "47 38 18 07 03 12 32 43 45 25",
    "02 08;42 48;05 45",
    "02 08",
    "38 33 22 12 03",
    "02 08;48 04;26 42",
    "08 02 42",
    "02 08 25 48 42",
    "02 08 42 48",
    "12 32 43 47 38 18 07 03 12",
    "02 08 38 47 45 34 04",
    "12 32 43 47 38 18 07 03 12;24 42",
    "02 08 38 47 45 34 04;24 42",
    "47 38 18 07 06 15 35 44 43 32 12 03",
    "08 48;22 28",
    "08 03 12 32 43 48",
    "08 22 48",
    "08 12 36 52 68",
    "02 48;08 42",
    "08 25 48;25 22",
    "08 48 02 42",
    "19 09 01 11",
    "09 41",
    "09 19 11 01",
    "06 28 46",
    "01 41",
    "08 17",
    "36 32;35 26 16 05 03 12 22 33",
    "08 02;05 16 26 35 33 22 12 03",
    "35 26 16 05 03 12 22 33",
    "38 32;35 26 16 05 03 12 22 33",
    "04 34 35 26 16 05 03 12 32",
    "28 17 12;06 26",
    "36 31 20 10 01;35 26 16 05 03 12 22 33",
    "08 02;05 16 26 35 32",
    "06 02;08",
    "16 11 00;18",
    "08 02;36 03;14 32",
    "08 03 12",
    "06 02;05 16 25 22;25 36 45 42",
    "06 02;05 16 26 35 32",
    "12 22 33 35 26 16 05 03 12",
    "06 00;05 16 26 35 33 22 12 03",
    "36 30;35 26 16 05 03 12 22 33",
    "06 02;05 16 26",
    "36 16 05 14 24 33 22 02",
    "18 13 22;06 26",
    "06 03 12 22 33;36 32",
    "06 22 46",
    "06 12 25 32 46",
    "02 36;06 32",
    "06 22;46 10",
    "06 36 02 32",
    "29 18 16 05 14 12 21",
    "09 01",
    "09 18 16 25 14 12 01",
    "05 16 34 45",
];

/// Further characters, of units and the like.
const MORE: [(char, &str); 5] = [
    ('\u{b0}', "16 07 18 27 16"),
    ('\u{b5}', "06 00;03 12 22 33;36 32"),
    ('\u{b7}', "05"),
    ('\u{b2}', "08 19 28 06 26"),
    ('\u{b3}', "09 29 17 26 15 05"),
];

/// The strokes of a character, if it has some.
fn glyph(letter: char) -> Option<&'static str> {
    let known = (letter as usize).checked_sub('!' as usize).and_then(|number| GLYPHS.get(number)).copied();
    known.or_else(|| MORE.iter().find(|(more, _)| *more == letter).map(|(_, glyph)| *glyph))
}

/// A character that has no strokes in others that have: letters without their accents, signs and raised digits as they are typed. A question mark for what is not known.
fn transliterated(letter: char) -> &'static str {
    match letter {
        'ä' => "ae",
        'ö' | 'œ' => "oe",
        'ü' => "ue",
        'Ä' => "Ae",
        'Ö' | 'Œ' => "Oe",
        'Ü' => "Ue",
        'ß' => "ss",
        'ẞ' => "SS",
        'æ' => "ae",
        'Æ' => "Ae",
        'à' | 'á' | 'â' | 'ã' | 'å' | 'ā' | 'ă' | 'ą' => "a",
        'À' | 'Á' | 'Â' | 'Ã' | 'Å' | 'Ā' | 'Ă' | 'Ą' => "A",
        'ç' | 'ć' | 'č' => "c",
        'Ç' | 'Ć' | 'Č' => "C",
        'ď' | 'đ' => "d",
        'Ď' | 'Đ' => "D",
        'è' | 'é' | 'ê' | 'ë' | 'ē' | 'ė' | 'ę' | 'ě' => "e",
        'È' | 'É' | 'Ê' | 'Ë' | 'Ē' | 'Ė' | 'Ę' | 'Ě' => "E",
        'ğ' => "g",
        'Ğ' => "G",
        'ì' | 'í' | 'î' | 'ï' | 'ī' | 'ı' => "i",
        'Ì' | 'Í' | 'Î' | 'Ï' | 'Ī' | 'İ' => "I",
        'ł' => "l",
        'Ł' => "L",
        'ñ' | 'ń' | 'ň' => "n",
        'Ñ' | 'Ń' | 'Ň' => "N",
        'ò' | 'ó' | 'ô' | 'õ' | 'ø' | 'ō' | 'ő' => "o",
        'Ò' | 'Ó' | 'Ô' | 'Õ' | 'Ø' | 'Ō' | 'Ő' => "O",
        'ř' => "r",
        'Ř' => "R",
        'ś' | 'š' | 'ş' => "s",
        'Ś' | 'Š' | 'Ş' => "S",
        'ť' => "t",
        'Ť' => "T",
        'ù' | 'ú' | 'û' | 'ū' | 'ů' | 'ű' => "u",
        'Ù' | 'Ú' | 'Û' | 'Ū' | 'Ů' | 'Ű' => "U",
        'ý' | 'ÿ' => "y",
        'Ý' | 'Ÿ' => "Y",
        'ź' | 'ż' | 'ž' => "z",
        'Ź' | 'Ż' | 'Ž' => "Z",
        // The small letter mu, which is not the sign of micro.
        'μ' => "\u{b5}",
        'α' => "alpha",
        'β' => "beta",
        'γ' => "gamma",
        'δ' => "delta",
        'Δ' => "Delta",
        'ε' => "epsilon",
        'θ' => "theta",
        'λ' => "lambda",
        'ν' => "nu",
        'π' => "pi",
        'ρ' => "rho",
        'σ' => "sigma",
        'τ' => "tau",
        'φ' => "phi",
        'ω' => "omega",
        'Ω' => "Ohm",
        '×' => "x",
        '⋅' | '∙' | '•' => "\u{b7}",
        '÷' => "/",
        '±' => "+-",
        '−' | '–' | '—' | '‐' | '‑' => "-",
        '→' => "->",
        '←' => "<-",
        '≤' => "<=",
        '≥' => ">=",
        '≈' => "~",
        '∞' => "inf",
        '…' => "...",
        '‘' | '’' | '′' => "'",
        '“' | '”' | '„' | '″' | '«' | '»' => "\"",
        // A letter with its accent behind it: the letter was drawn.
        '\u{300}'..='\u{36f}' => "",
        _ => "?",
    }
}

/// A raised digit or sign as it is on the line.
fn lowered(letter: char) -> Option<char> {
    const RAISED: [char; 12] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁺', '⁻'];
    RAISED.iter().zip("0123456789+-".chars()).find(|(raised, _)| **raised == letter).map(|(_, lowered)| lowered)
}

/// A text in characters that have strokes, and blanks.
fn writable(text: &str) -> String {
    let mut out = String::new();
    let mut is_raised = false;
    for letter in text.chars() {
        let lowered = lowered(letter);
        match lowered {
            Some(digit) if is_raised => out.push(digit),
            Some(digit) if glyph(letter).is_none() => out.extend(['^', digit]),
            _ if letter.is_whitespace() || glyph(letter).is_some() => out.push(letter),
            _ => out += transliterated(letter),
        }
        is_raised = lowered.is_some();
    }
    out
}

/// Strokes of a glyph, of which every point is two digits.
fn strokes(glyph: &'static str) -> impl Iterator<Item = Vec<[f64; 2]>> {
    let digit = |byte: u8| f64::from(byte - b'0');
    glyph.split(';').map(move |stroke| {
        stroke.split(' ').map(|point| point.as_bytes()).map(|point| [digit(point[0]), digit(point[1])]).collect()
    })
}

fn widest(glyph: &'static str) -> f64 {
    strokes(glyph).flatten().fold(0.0, |widest, point| point[0].max(widest))
}

/// The strokes of a text on its base line, which begins at zero, for letters of this size, with y downwards; and its width.
pub fn written(text: &str, size: f64) -> (Vec<Vec<[f64; 2]>>, f64) {
    let unit = UNIT * size;
    let (mut out, mut x) = (Vec::new(), 0.0);
    for letter in writable(text).chars() {
        let Some(glyph) = glyph(letter) else {
            x += BLANK + GAP;
            continue;
        };
        let place = |[column, row]: [f64; 2]| [(x + column) * unit, (BASE - row) * unit];
        out.extend(strokes(glyph).map(|stroke| stroke.into_iter().map(place).collect()));
        x += widest(glyph) + GAP;
    }
    (out, (x - GAP).max(0.0) * unit)
}

/// A size of letters at which a text is no wider than its place, and no larger than this one. Other letters, as those of an SVG picture, are about as wide.
pub fn fitted(text: &str, size: f64, room: f64) -> f64 {
    let (_, width) = written(text, size);
    if width > room { (size * room / width * 10.0).floor() / 10.0 } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_character_has_its_own_strokes_on_the_grid() {
        for letter in '!'..='~' {
            for point in strokes(glyph(letter).unwrap()).flatten() {
                assert!(point[0] <= 6.0 && point[1] <= 9.0, "{letter}");
            }
        }
        let different: BTreeSet<&str> = ('!'..='~').filter_map(glyph).collect();
        // Zero and the letter O are the same, and no others.
        assert_eq!((different.len(), glyph('0')), (93, glyph('O')));
    }

    /// Pictures of pixels have no font: what has no strokes is written in characters that have, and never left out.
    #[test]
    fn other_characters_are_written_in_those_that_have_strokes() {
        for (text, wanted) in [
            ("Prüfkörper Ä ß", "Pruefkoerper Ae ss"),
            ("éàçñ Škoda", "eacn Skoda"),
            ("10⁷ N", "10^7 N"),
            ("10⁻⁵", "10^-5"),
            ("10⁻³ m²", "10^-3 m²"),
            ("5 kg⋅m", "5 kg·m"),
            ("2 × 3 ≤ σ ± 1", "2 x 3 <= sigma +- 1"),
            ("μm", "µm"),
            ("e\u{301}", "e"),
            ("Ж物\u{1f600}", "???"),
        ] {
            assert_eq!((writable(text).as_str(), written(text, 10.0)), (wanted, written(wanted, 10.0)), "{text}");
        }
        // Those of units have strokes of their own.
        let own: BTreeSet<&str> = "²³·°µ".chars().map(|letter| glyph(letter).unwrap()).collect();
        assert_eq!(own.len(), 5);
        // All that characters are written in has strokes.
        for letter in ('\u{a1}'..='\u{2fff}').filter(|letter| glyph(*letter).is_none()) {
            assert!(transliterated(letter).chars().all(|letter| glyph(letter).is_some()), "{letter}");
        }
    }

    #[test]
    fn capitals_are_0_72_high_and_a_text_is_as_wide_as_its_letters() {
        let (strokes, width) = written("H H", 10.0);
        let points = || strokes.iter().flatten();
        let [low, high] = [f64::min, f64::max].map(|of| points().map(|point| point[1]).reduce(of).unwrap());
        assert!((low + 7.2).abs() < 1e-12 && high.abs() < 1e-12);
        let right = points().map(|point| point[0]).reduce(f64::max).unwrap();
        assert!((right - width).abs() < 1e-12 && (width - 1.2 * (8.0 + 2.0 * GAP + BLANK)).abs() < 1e-9);
        assert_eq!(written("", 10.0), (Vec::new(), 0.0));
        assert_eq!(fitted("H H", 10.0, width), 10.0);
        assert!((fitted("H H", 10.0, 0.5 * width) - 5.0).abs() <= 0.1);
    }
}
