use image::{GrayImage, Rgb, RgbImage};

use super::{Key, Result};
use crate::world::Colour;

/// A pixel of the display: column and row from the upper left corner, which is `(0, 0)`.
pub type Pixel = (i32, i32);

/// Filling of a closed shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Fill {
    /// Its border alone, one pixel wide.
    Outline,
    /// Border and inside.
    Solid,
}

/// Font of text, as in RoBIOS. A display that lacks a family, style or size uses the nearest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Font {
    /// Typeface.
    pub family: FontFamily,
    /// Weight and slant.
    pub style: FontStyle,
    /// Size: 8, 10, 12, 14, 18 or 24. Others are rounded to the nearest; 0 or less means the default of 12.
    pub size: i32,
}

/// Typeface of a font.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FontFamily {
    /// Without serifs.
    #[default]
    Helvetica,
    /// With serifs.
    Times,
    /// Monospaced.
    Courier,
}

/// Weight and slant of a font.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FontStyle {
    /// Upright.
    #[default]
    Normal,
    /// Heavy.
    Bold,
    /// Slanted.
    Italic,
}

/// A display setting that can be switched on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum DisplayOption {
    /// Drawing is visible at once; otherwise at the next [`refresh`](Display::refresh). Initially on.
    AutoRefresh,
    /// A new line below the last row scrolls by one row; otherwise further rows are lost. Initially on.
    Scrolling,
    /// A newline moves to the start of the next row; otherwise straight down. Initially on.
    LineFeed,
    /// Shows the soft keys' labels. Off until a label is set.
    Menu,
    /// Text leaves the pixels between its strokes unchanged instead of filling the background. Initially off.
    TransparentText,
    /// Inverts the foreground colour of text. Initially off.
    InvertedForeground,
    /// Inverts the background colour of text. Initially off.
    InvertedBackground,
}

/// Position and size of an image on the display.
///
/// The default is RoBIOS's place for camera images: a QVGA window, 320 x 240 pixels, in the upper left
/// corner.
///
/// ```
/// use roverlab::io::Viewport;
/// let right_half = Viewport::new((160, 0), 160, 240);
/// assert_eq!((right_half.corner, right_half.width, right_half.height), ((160, 0), 160, 240));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Viewport {
    /// Upper left corner.
    pub corner: Pixel,
    /// Width in pixels; nothing is drawn for 0 or less.
    pub width: i32,
    /// Height in pixels; nothing is drawn for 0 or less.
    pub height: i32,
}

impl Viewport {
    /// Creates a window from its upper left corner and its size.
    pub const fn new(corner: Pixel, width: i32, height: i32) -> Self {
        Self { corner, width, height }
    }
}

impl Default for Viewport {
    fn default() -> Self {
        Self::new((0, 0), 320, 240)
    }
}

/// An image for the display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DisplayImage<'a> {
    /// In colour.
    Rgb(&'a RgbImage),
    /// Grayscale, 0 black to 255 white.
    Gray(&'a GrayImage),
    /// Black and white: 0 is white and anything else black, as in RoBIOS and the PBM format.
    Binary(&'a GrayImage),
}

impl DisplayImage<'_> {
    /// Number of columns and rows.
    pub fn dimensions(&self) -> (u32, u32) {
        match self {
            DisplayImage::Rgb(image) => image.dimensions(),
            DisplayImage::Gray(image) | DisplayImage::Binary(image) => image.dimensions(),
        }
    }

    /// The colour of a pixel; `None` outside the image.
    pub fn colour(&self, x: u32, y: u32) -> Option<Colour> {
        match self {
            DisplayImage::Rgb(image) => {
                image.get_pixel_checked(x, y).map(|&Rgb([red, green, blue])| Colour::new(red, green, blue))
            }
            DisplayImage::Gray(image) => image.get_pixel_checked(x, y).map(|p| Colour::new(p[0], p[0], p[0])),
            DisplayImage::Binary(image) => {
                image.get_pixel_checked(x, y).map(|p| if p[0] == 0 { Colour::WHITE } else { Colour::BLACK })
            }
        }
    }
}

impl<'a> From<&'a RgbImage> for DisplayImage<'a> {
    fn from(image: &'a RgbImage) -> Self {
        DisplayImage::Rgb(image)
    }
}

impl<'a> From<&'a GrayImage> for DisplayImage<'a> {
    fn from(image: &'a GrayImage) -> Self {
        DisplayImage::Gray(image)
    }
}

/// A colour display with text and graphics, as in RoBIOS (book, appendix, LCD functions).
///
/// All drawing is clipped: parts outside the display are ignored without an error.
///
/// # For implementers
///
/// Clip whatever lies outside and return no error for it. [`Lcd`](super::Lcd) implements all of it in
/// memory, for robots that only need to show the result.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Display {
    /// Prints at the cursor and moves it behind the text. Lines wrap at the right edge; `\n` starts a new
    /// line.
    fn print(&mut self, text: &str) -> Result<()>;

    /// Moves the cursor and prints there.
    fn print_at(&mut self, row: i32, column: i32, text: &str) -> Result<()> {
        self.set_cursor(row, column)?;
        self.print(text)
    }

    /// Moves the cursor; rows and columns are those of the current font, counted from 0.
    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()>;

    /// Row and column of the cursor.
    fn cursor(&mut self) -> Result<(i32, i32)>;

    /// Sets the colours of later text, and of the cleared display.
    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()>;

    /// Sets the font of later text.
    fn set_font(&mut self, font: Font) -> Result<()>;

    /// Fills the display with the background colour and moves the cursor to row 0, column 0. The soft keys'
    /// labels stay.
    fn clear_display(&mut self) -> Result<()>;

    /// Width and height in pixels, including the bar of the soft keys.
    fn display_size(&mut self) -> Result<(i32, i32)>;

    /// Sets a pixel.
    fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()>;

    /// Colour of a pixel as last drawn, whether or not visible yet; `None` outside the display.
    fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>>;

    /// Draws a line that includes both ends.
    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()>;

    /// Draws an axis-parallel rectangle between two opposite corners, both included, in any order.
    fn draw_rectangle(&mut self, corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> Result<()>;

    /// Draws a circle of `diameter` pixels. With an even diameter, the centre is the pixel to the upper left
    /// of the true one. Nothing is drawn for 0 or less.
    fn draw_circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()>;

    /// Draws an image, scaled to a window by nearest-neighbour sampling.
    fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()>;

    /// Labels a soft key in the bar at the bottom of the display, and shows the bar.
    fn set_menu_label(&mut self, key: Key, label: &str, foreground: Colour, background: Colour)
    -> Result<()>;

    /// Labels all four soft keys from left to right in the default colours, and shows the bar.
    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()>;

    /// Switches a display setting on or off.
    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()>;

    /// Shows what was drawn while [`DisplayOption::AutoRefresh`] was off.
    fn refresh(&mut self) -> Result<()>;

    /// A copy of what the display shows.
    fn screenshot(&mut self) -> Result<RgbImage>;
}
