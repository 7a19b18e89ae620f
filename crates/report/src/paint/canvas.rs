//! What pictures are drawn with: a picture is composed once, and each format carries out the same few commands.

/// A colour: red, green, blue.
pub type Colour = [u8; 3];

/// Colour of texts; then of the rims of lines and points.
pub const INK: Colour = [0x33, 0x33, 0x33];
pub const EDGE: Colour = [0x22, 0x22, 0x22];
/// Part of the edges' colour in what is drawn of them, and their width in pixels.
pub const EDGE_OPACITY: f64 = 0.5;
pub const EDGE_WIDTH: f64 = 0.5;

/// Width of lines, diameter of points and width of the dark rims around both, in pixels.
pub const LINE: f64 = 3.2;
pub const DOT: f64 = 9.0;
pub const RIM: f64 = 0.7;

/// Where a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The middle of the text is there.
    Middle,
}

/// Carries out drawing commands in their order. Places are in pixels from the upper left corner, downwards.
pub trait Canvas {
    /// A text on a line.
    fn text(&mut self, text: &str, place: [f64; 2], size: f64, anchor: Anchor);
    /// A filled rectangle, from its upper left corner.
    fn rectangle(&mut self, colour: Colour, corner: [f64; 2], size: [f64; 2]);
    /// Begins a drawing whose places are counted from this one, until [`Canvas::leave`].
    fn enter(&mut self, origin: [f64; 2]);
    /// Ends what [`Canvas::enter`] began.
    fn leave(&mut self);
    /// A filled quadrilateral without edges.
    fn piece(&mut self, colour: Colour, corners: &[[f64; 2]; 4]);
    /// Edges of a face, those that are chosen: the first is that from the first to the second corner.
    fn edges(&mut self, corners: &[[f64; 2]; 4], chosen: [bool; 4]);
    /// A part of a line, with a rim.
    fn line(&mut self, colour: Colour, ends: &[[f64; 2]; 2]);
    /// A point, with a rim.
    fn disc(&mut self, colour: Colour, centre: [f64; 2]);
}
