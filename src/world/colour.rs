use std::fmt;

/// An opaque colour with 8 bits per channel.
///
/// ```
/// use roverlab::world::Colour;
/// assert_eq!(Colour::from_hex(0xff_80_00), Colour::new(255, 128, 0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Colour {
    /// Red, 0 to 255.
    pub red: u8,
    /// Green, 0 to 255.
    pub green: u8,
    /// Blue, 0 to 255.
    pub blue: u8,
}

impl Colour {
    /// Black.
    pub const BLACK: Colour = Colour::new(0, 0, 0);
    /// White.
    pub const WHITE: Colour = Colour::new(255, 255, 255);
    /// Red.
    pub const RED: Colour = Colour::new(255, 0, 0);
    /// Green.
    pub const GREEN: Colour = Colour::new(0, 255, 0);
    /// Blue.
    pub const BLUE: Colour = Colour::new(0, 0, 255);

    /// A colour from its channels.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// A colour from `0xRRGGBB`.
    pub const fn from_hex(rgb: u32) -> Self {
        Self::new((rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8)
    }
}

impl From<Colour> for [u8; 3] {
    fn from(colour: Colour) -> Self {
        [colour.red, colour.green, colour.blue]
    }
}

impl fmt::Display for Colour {
    /// `#rrggbb`, as in SVG.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }
}
