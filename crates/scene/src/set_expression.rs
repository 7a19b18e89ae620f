//! Expressions over sets: `"block.top & x > 0.2"`.
//!
//! Wherever a scene names a set of nodes, facets or elements, it may write an expression instead. All sets in it belong to one part.
//!
//! | written | holds at |
//! |---|---|
//! | `part.set`, `part.'odd name'` | the nodes, facets, elements of the set; a name that is no word is put in single quotes |
//! | a name of the table `[sets]` | the same |
//! | `x > 0.2`, `0 <= x <= 1`, `hypot(x, y) = radius` | nodes by reference coordinates `x y z` in place of the part; `< <= > >= = !=`, chains, and arithmetic with the parameters |
//! | `nearest(part, 0.1, 0.2, 0)` | the node nearest to a point, of a part or of a set |
//! | `normal(part, 0, 0, 1, 30)` | facets whose outward reference normal is within 30 degrees of a direction |
//! | `!a`, `a & b`, `a - b`, `a \| b`, `( )` | not, and, and not, or; `!` binds closest, then `&` and `-`, then `\|`. The minus of sets has blanks around it |
//!
//! The facets of an expression are those of the surface at all of whose nodes it holds, where a set of facets in it holds for its own facets; likewise
//! elements.
//!
//! # What it is not
//! No evaluation: that needs the mesh, and is the facade's.

pub use crate::expression::Formula;

/// An expression that a scene uses, or gives a name in `[sets]`.
#[derive(Clone, Debug)]
pub struct SetExpression {
    /// The part to which all of its sets belong.
    pub part: String,
    /// Name of the expression as a set of the part: what follows the first dot of [`Self::reference`].
    pub name: String,
    /// Key at which it was found first.
    pub key: String,
    /// The expression.
    pub region: SetRegion,
}

impl SetExpression {
    /// The reference `part.name`, as the keys of the scene have it.
    pub fn reference(&self) -> String {
        format!("{}.{}", self.part, self.name)
    }
}

/// A part of an expression with its text.
#[derive(Clone, Debug)]
pub struct SetRegion {
    /// Text of the part as it was written.
    pub text: String,
    /// Kind of the part.
    pub kind: RegionKind,
}

/// Where a part of an expression holds.
#[derive(Clone, Debug)]
pub enum RegionKind {
    /// A set of the part, by its name there.
    Set(String),
    /// Where a comparison of coordinates holds.
    Comparison {
        /// Left side minus right side.
        difference: Formula,
        /// How it compares with zero.
        relation: Relation,
    },
    /// The node nearest to a point.
    Nearest {
        /// Among these nodes.
        within: Box<SetRegion>,
        /// The point, in the reference configuration.
        point: [f64; 3],
    },
    /// Facets by their outward reference normal.
    Normal {
        /// Among these facets.
        within: Box<SetRegion>,
        /// Direction, not zero.
        direction: [f64; 3],
        /// Largest angle between the two, from 0 to 180.
        degrees: f64,
    },
    /// Where something does not hold.
    Not(Box<SetRegion>),
    /// Where all hold.
    All(Vec<SetRegion>),
    /// Where any holds.
    Any(Vec<SetRegion>),
}

/// Relation of a difference to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
    /// `=`
    Equal,
    /// `!=`
    NotEqual,
}

impl Relation {
    /// Whether a difference that is zero to a tolerance, or else has a sign, stands in this relation. NaN stands in none.
    pub fn holds(self, difference: f64, tolerance: f64) -> bool {
        let equal = difference.abs() <= tolerance;
        match self {
            Self::Less => difference < 0.0 && !equal,
            Self::LessOrEqual => difference < 0.0 || equal,
            Self::Greater => difference > 0.0 && !equal,
            Self::GreaterOrEqual => difference > 0.0 || equal,
            Self::Equal => equal,
            Self::NotEqual => !equal && !difference.is_nan(),
        }
    }
}
