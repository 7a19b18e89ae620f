//! Arithmetic expressions over parameters: `"2*radius + 1e-3"`.
//!
//! | written | is |
//! |---|---|
//! | `+ - * / ^` | as usual; `^` binds closest and to the right, so that `-2^2` is -4 and `2^3^2` is 512 |
//! | `( )` | brackets |
//! | `pi`, other names | the number pi; parameters |
//! | `sqrt exp ln log10 abs sin cos tan asin acos atan floor ceil round radians degrees` | of one argument, angles in radians |
//! | `min max atan2 hypot` | of two arguments |
//!
//! It is a parser of its own because the crates that were tried read `1e-3` as `1e - 3` (exmex 0.21), have a licence that Stoss cannot
//! have (evalexpr from 12 on) or are without maintenance (meval, fasteval), and none says where in the expression the mistake is.

/// Deepest nesting of brackets, signs and powers.
const DEPTH: usize = 64;

/// Most operations of a formula in which variables appear.
const SIZE: usize = 1000;

/// Functions of one argument.
const UNARY: [(&str, fn(f64) -> f64); 15] = [
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("abs", f64::abs),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("round", f64::round),
    ("radians", f64::to_radians),
];

/// Functions of two arguments.
const BINARY: [(&str, fn(f64, f64) -> f64); 4] =
    [("min", f64::min), ("max", f64::max), ("atan2", f64::atan2), ("hypot", f64::hypot)];

/// Why an expression has no value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExpressionError {
    /// What is wrong, and at which character, from 1.
    Wrong { message: String, at: usize },
    /// A name that is no parameter.
    UnknownName(String),
    /// A parameter whose own value is wrong, which is reported where it stands.
    Reported,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Name {
    Value(f64),
    /// A variable by its number; in expressions over sets 0, 1 and 2 are the coordinates.
    Variable(usize),
    /// A known name whose value is wrong, which is reported elsewhere.
    Wrong,
    Unknown,
}

/// Whether a name can stand in an expression for a parameter: a letter, then letters, digits and `_`, and no name of this module's.
pub(crate) fn is_parameter_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(char::is_alphabetic)
        && characters.all(|c| c.is_alphanumeric() || c == '_')
        && !is_reserved(name)
}

/// Names of functions, constants and coordinates: `x`, `y`, `z` in an expression over sets are never a parameter.
fn is_reserved(name: &str) -> bool {
    matches!(name, "pi" | "degrees" | "x" | "y" | "z")
        || UNARY.iter().any(|(known, _)| *known == name)
        || BINARY.iter().any(|(known, _)| *known == name)
}

/// A scalar function of variables, without variables a number. In an expression over sets they are the three coordinates.
#[derive(Clone, Debug)]
pub struct Formula(Term);

#[derive(Clone, Debug)]
enum Term {
    Number(f64),
    Variable(usize),
    Unary(fn(f64) -> f64, Box<Term>),
    Binary(fn(f64, f64) -> f64, Box<[Term; 2]>),
}

impl Formula {
    /// Reads a formula in which these names are the variables, in their order.
    ///
    /// # Errors
    /// What is wrong with it, as the end of a sentence.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, String> {
        let lookup =
            |name: &str| variables.iter().position(|known| *known == name).map_or(Name::Unknown, Name::Variable);
        whole(text, &lookup).map(Self).map_err(|error| match error {
            ExpressionError::Wrong { message, .. } => message,
            ExpressionError::UnknownName(name) => format!("the name `{name}` is not known"),
            ExpressionError::Reported => "a value is missing".to_owned(),
        })
    }

    /// Value of the formula for values of the variables; it may be infinite or no number, as in `1/x` at zero, and is NaN if one of its variables has no value.
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.0.value(variables)
    }

    /// Value of the formula if no variable appears in it.
    pub fn constant(&self) -> Option<f64> {
        match self.0 {
            Term::Number(value) => Some(value),
            _ => None,
        }
    }
}

impl Term {
    fn value(&self, variables: &[f64]) -> f64 {
        match self {
            Self::Number(value) => *value,
            Self::Variable(i) => variables.get(*i).copied().unwrap_or(f64::NAN),
            Self::Unary(function, argument) => function(argument.value(variables)),
            Self::Binary(function, arguments) => function(arguments[0].value(variables), arguments[1].value(variables)),
        }
    }
}

/// The value of an expression, which is finite.
pub(crate) fn evaluate(text: &str, lookup: &dyn Fn(&str) -> Name) -> Result<f64, ExpressionError> {
    let value = whole(text, lookup)?.value(&[0.0; 3]);
    if !value.is_finite() {
        return Err(ExpressionError::Wrong { message: format!("gives {value}, which is not a finite number"), at: 1 });
    }
    Ok(value)
}

/// The term that a whole text is.
fn whole(text: &str, lookup: &dyn Fn(&str) -> Name) -> Result<Term, ExpressionError> {
    let mut parser = Parser { text, at: 0, depth: 0, size: 0, lookup };
    let term = parser.sum()?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser.wrong("an operator is missing here, or a bracket is superfluous"));
    }
    Ok(term)
}

/// The longest formula that starts at a byte of a text, and the byte at which it ends.
pub(crate) fn formula(
    text: &str,
    at: usize,
    lookup: &dyn Fn(&str) -> Name,
) -> Result<(Formula, usize), ExpressionError> {
    let mut parser = Parser { text, at, depth: 0, size: 0, lookup };
    let term = parser.sum()?;
    Ok((Formula(term), parser.at))
}

struct Parser<'a> {
    text: &'a str,
    /// Byte at which the rest begins.
    at: usize,
    depth: usize,
    /// Operations that depend on variables so far.
    size: usize,
    lookup: &'a dyn Fn(&str) -> Name,
}

type Value = Result<Term, ExpressionError>;

impl Parser<'_> {
    fn rest(&self) -> &str {
        // `at` moves by whole characters only.
        self.text.get(self.at..).unwrap_or_default()
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    /// The next character that is no space, which stays.
    fn peek(&mut self) -> Option<char> {
        self.skip_space();
        self.rest().chars().next()
    }

    /// Takes a character if it is the next one.
    fn take(&mut self, character: char) -> bool {
        let found = self.peek() == Some(character);
        if found {
            self.at += character.len_utf8();
        }
        found
    }

    fn wrong(&self, message: &str) -> ExpressionError {
        let at = 1 + self.text.get(..self.at).map_or(0, |before| before.chars().count());
        ExpressionError::Wrong { message: message.to_owned(), at }
    }

    /// The function of a term, computed at once if that is a number.
    fn unary(&mut self, function: fn(f64) -> f64, argument: Term) -> Value {
        if let Term::Number(a) = argument {
            return Ok(Term::Number(function(a)));
        }
        self.grow()?;
        Ok(Term::Unary(function, Box::new(argument)))
    }

    /// A function of two terms, as of [`Self::unary`].
    fn binary(&mut self, function: fn(f64, f64) -> f64, first: Term, second: Term) -> Value {
        if let (Term::Number(a), Term::Number(b)) = (&first, &second) {
            return Ok(Term::Number(function(*a, *b)));
        }
        self.grow()?;
        Ok(Term::Binary(function, Box::new([first, second])))
    }

    fn grow(&mut self) -> Result<(), ExpressionError> {
        self.size += 1;
        if self.size > SIZE { Err(self.wrong("is too long")) } else { Ok(()) }
    }

    fn sum(&mut self) -> Value {
        let mut value = self.product()?;
        loop {
            if self.take('+') {
                let other = self.product()?;
                value = self.binary(|a, b| a + b, value, other)?;
            } else if self.take('-') {
                let other = self.product()?;
                value = self.binary(|a, b| a - b, value, other)?;
            } else {
                return Ok(value);
            }
        }
    }

    fn product(&mut self) -> Value {
        let mut value = self.signed()?;
        loop {
            if self.take('*') {
                let other = self.signed()?;
                value = self.binary(|a, b| a * b, value, other)?;
            } else if self.take('/') {
                let other = self.signed()?;
                value = self.binary(|a, b| a / b, value, other)?;
            } else {
                return Ok(value);
            }
        }
    }

    fn signed(&mut self) -> Value {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(self.wrong("is nested too deeply"));
        }
        let value = if self.take('-') {
            let value = self.signed()?;
            self.unary(|a| -a, value)?
        } else if self.take('+') {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        Ok(value)
    }

    fn power(&mut self) -> Value {
        let base = self.atom()?;
        if self.take('^') {
            let exponent = self.signed()?;
            return self.binary(f64::powf, base, exponent);
        }
        Ok(base)
    }

    fn atom(&mut self) -> Value {
        match self.peek() {
            Some('(') => {
                self.take('(');
                let value = self.sum()?;
                self.close()?;
                Ok(value)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() => self.name(),
            Some(_) => Err(self.wrong("a number, a parameter or a bracket is missing here")),
            None => Err(self.wrong("ends too early")),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.take(')') { Ok(()) } else { Err(self.wrong("a closing bracket is missing here")) }
    }

    /// Digits with a point and an exponent.
    fn number(&mut self) -> Value {
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let digits =
            |from: usize| bytes[from.min(bytes.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end += 1;
            end += digits(end);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > 0 {
                end += 1 + sign + exponent;
            }
        }
        let value = rest.get(..end).and_then(|text| text.parse().ok());
        let value = value.ok_or_else(|| self.wrong("is not a number"))?;
        self.at += end;
        Ok(Term::Number(value))
    }

    fn name(&mut self) -> Value {
        let rest = self.rest();
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = rest.get(..length).unwrap_or_default().to_owned();
        if name == "pi" {
            self.at += length;
            return Ok(Term::Number(std::f64::consts::PI));
        }
        let unary = UNARY.iter().find(|(known, _)| *known == name).map(|(_, function)| *function);
        let unary = unary.or((name == "degrees").then_some(f64::to_degrees as fn(f64) -> f64));
        let binary = BINARY.iter().find(|(known, _)| *known == name).map(|(_, function)| *function);
        if unary.is_some() || binary.is_some() {
            self.at += length;
            if !self.take('(') {
                return Err(self.wrong(&format!("`{name}` needs its arguments in brackets")));
            }
            let first = self.sum()?;
            let value = match (unary, binary) {
                (Some(function), _) => self.unary(function, first)?,
                (None, Some(function)) => {
                    if !self.take(',') {
                        return Err(self.wrong(&format!("`{name}` needs two arguments with a comma between them")));
                    }
                    let second = self.sum()?;
                    self.binary(function, first, second)?
                }
                (None, None) => first,
            };
            self.close()?;
            return Ok(value);
        }
        match (self.lookup)(&name) {
            Name::Value(value) => {
                self.at += length;
                Ok(Term::Number(value))
            }
            Name::Variable(i) => {
                self.at += length;
                Ok(Term::Variable(i))
            }
            Name::Wrong => Err(ExpressionError::Reported),
            Name::Unknown => Err(ExpressionError::UnknownName(name)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(text: &str) -> Result<f64, ExpressionError> {
        evaluate(text, &|name| match name {
            "radius" => Name::Value(0.5),
            "x_1" => Name::Value(-3.0),
            "bad" => Name::Wrong,
            _ => Name::Unknown,
        })
    }

    #[test]
    fn expressions_have_the_values_of_arithmetic() {
        for (text, expected) in [
            ("2*radius", 1.0),
            ("1e-3", 1e-3),
            ("1e-3*2", 2e-3),
            ("2.5E+2 - .5", 249.5),
            ("1.", 1.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("--2", 2.0),
            ("7 - 2 - 1", 4.0),
            ("8 / 4 / 2", 1.0),
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("x_1 ^ 2", 9.0),
            ("sqrt(16) + abs(x_1)", 7.0),
            ("min(1, 2) + max(1, 2)", 3.0),
            ("hypot(3, 4)", 5.0),
            ("atan2(1, 1) * 4 / pi", 1.0),
            ("degrees(radians(30))", 30.0),
            ("log10(1000)", 3.0),
            ("round(2.4) + floor(2.6) + ceil(2.2)", 7.0),
        ] {
            let found = value(text).unwrap();
            assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{text}: {found}");
        }
    }

    #[test]
    fn mistakes_are_located() {
        for (text, at) in [
            ("", 1),
            ("2*", 3),
            ("(1 + 2", 7),
            ("1 + 2)", 6),
            ("2 radius", 3),
            ("2**3", 3),
            ("sqrt 4", 6),
            ("min(1)", 6),
            ("max(1, 2, 3)", 9),
            ("é + $", 1),
            (".", 1),
            ("1 + é * $", 5),
            ("1 / 0", 1),
            ("sqrt(-1)", 1),
        ] {
            match value(text) {
                Err(ExpressionError::Wrong { at: found, .. }) => assert_eq!(found, at, "{text}"),
                Err(ExpressionError::UnknownName(name)) => assert_eq!(name, "é", "{text}"),
                other => panic!("{text}: {other:?}"),
            }
        }
        assert_eq!(value("2*raduis"), Err(ExpressionError::UnknownName("raduis".into())));
        assert_eq!(value("2*bad"), Err(ExpressionError::Reported));
        for text in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000)] {
            assert!(matches!(value(&text), Err(ExpressionError::Wrong { .. })));
        }
    }

    #[test]
    fn formulas_have_the_values_of_their_variables() {
        let formula = Formula::parse("2*kinetic + abs(loss)", &["loss", "kinetic"]).unwrap();
        assert_eq!((formula.value(&[-1.0, 3.0]), formula.constant()), (7.0, None));
        assert!(formula.value(&[-1.0]).is_nan());
        assert_eq!(Formula::parse("2*3", &[]).unwrap().constant(), Some(6.0));
        for (text, says) in [("2*a", "`a`"), ("2*", "ends too early"), ("2 3", "operator")] {
            assert!(Formula::parse(text, &["b"]).unwrap_err().contains(says), "{text}");
        }
    }

    #[test]
    fn names_of_functions_are_no_parameters() {
        assert!(["radius", "x_1", "µ", "e"].into_iter().all(is_parameter_name));
        assert!(
            !["", "1x", "a-b", "a.b", "pi", "min", "sqrt", "degrees", "_a", "x", "y", "z"]
                .into_iter()
                .any(is_parameter_name)
        );
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[-+*/^()., 0-9a-eéµ]{0,40}") {
            let _ = value(&text);
        }

        /// Numbers come back with all their digits.
        #[test]
        fn numbers_are_read_exactly(number in proptest::num::f64::NORMAL) {
            prop_assert_eq!(value(&format!("{number:e}")), Ok(number));
            prop_assert_eq!(value(&format!("{number}")), Ok(number));
        }
    }
}
