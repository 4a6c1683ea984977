mod canvas;
mod fonts;

use embedded_graphics::Drawable;
use embedded_graphics::geometry::Point;
use embedded_graphics::mono_font::{MonoFont, MonoTextStyleBuilder, iso_8859_1};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::text::{Baseline, Text};
use image::RgbImage;

use canvas::Canvas;

use crate::io::{Display, DisplayImage, DisplayOption, Fill, Font, Key, Pixel, Result, Viewport};
use crate::world::Colour;

/// Pixels above the first row of text. With this offset and the default font, row 18 is the first one wholly
/// below a QVGA image and row 20 the last one above the soft keys' labels.
const TEXT_TOP: i32 = 6;

/// Distance of tab stops (characters).
const TAB: i32 = 8;

/// Default colours of a soft key's label and of its background.
const DEFAULT_LABEL: (Colour, Colour) = (Colour::WHITE, Colour::from_hex(0x0040_4040));

/// Display of a simulated robot: a frame buffer of 480 x 320 pixels that can be saved as a picture.
///
/// Text is drawn in fixed-width letters of the Latin-1 character set, whatever the font's family; other
/// characters appear as a question mark. The default font has 24 rows of 80 letters, 21 rows with the soft
/// keys' labels; rows 18 to 20 lie below an image in the default [`Viewport`].
///
/// ```
/// use roverlab::io::Lcd;
/// use roverlab::io::{Display, Fill};
/// use roverlab::world::Colour;
///
/// # fn main() -> roverlab::io::Result<()> {
/// let mut lcd = Lcd::new();
/// lcd.print("distance 0.42 m\n")?;
/// lcd.draw_circle((240, 160), 50, Colour::RED, Fill::Solid)?;
/// // Any coordinates are valid: the display clips.
/// lcd.draw_line((240, 160), (240, -9999), Colour::GREEN)?;
/// assert_eq!(lcd.cursor()?, (1, 0));
/// assert_eq!(lcd.frame().get_pixel(230, 160).0, [255, 0, 0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Lcd {
    canvas: Canvas,
    /// Visible image while automatic refresh is off.
    frozen: Option<RgbImage>,
    row: i32,
    column: i32,
    foreground: Colour,
    background: Colour,
    font: Font,
    options: Vec<DisplayOption>,
    labels: [Label; 4],
}

#[derive(Debug, Clone)]
struct Label {
    text: String,
    foreground: Colour,
    background: Colour,
}

impl Default for Label {
    fn default() -> Self {
        let (foreground, background) = DEFAULT_LABEL;
        Self { text: String::new(), foreground, background }
    }
}

impl Default for Lcd {
    fn default() -> Self {
        Self {
            canvas: Canvas::new(Self::WIDTH, Self::HEIGHT),
            frozen: None,
            row: 0,
            column: 0,
            foreground: Colour::WHITE,
            background: Colour::BLACK,
            font: Font::default(),
            options: vec![DisplayOption::AutoRefresh, DisplayOption::Scrolling, DisplayOption::LineFeed],
            labels: Default::default(),
        }
    }
}

impl Lcd {
    /// Width in pixels.
    pub const WIDTH: u32 = 480;
    /// Height in pixels.
    pub const HEIGHT: u32 = 320;
    /// Height of the soft keys' labels in pixels.
    pub const MENU_HEIGHT: u32 = 38;

    /// A black display with white text.
    pub fn new() -> Self {
        Self::default()
    }

    /// The visible image.
    pub fn frame(&self) -> &RgbImage {
        self.frozen.as_ref().unwrap_or_else(|| self.canvas.image())
    }

    /// Labels of the soft keys from left to right; empty without one.
    pub fn menu(&self) -> [&str; 4] {
        self.labels.each_ref().map(|label| label.text.as_str())
    }

    /// Number of rows and columns of text in the current font.
    pub fn text_size(&self) -> (i32, i32) {
        let (width, height) = fonts::cell(self.face());
        ((self.text_bottom() - TEXT_TOP) / height, self.canvas.width() / width)
    }

    fn has(&self, option: DisplayOption) -> bool {
        self.options.contains(&option)
    }

    fn face(&self) -> &'static MonoFont<'static> {
        fonts::face(self.font)
    }

    fn menu_top(&self) -> i32 {
        self.canvas.height() - Self::MENU_HEIGHT as i32
    }

    fn text_bottom(&self) -> i32 {
        if self.has(DisplayOption::Menu) { self.menu_top() } else { self.canvas.height() }
    }

    /// Colours of text after inversion; the background is `None` for transparent text.
    fn text_colours(&self) -> (Colour, Option<Colour>) {
        let choose = |colour: Colour, option| if self.has(option) { inverse(colour) } else { colour };
        let foreground = choose(self.foreground, DisplayOption::InvertedForeground);
        let background = choose(self.background, DisplayOption::InvertedBackground);
        (foreground, (!self.has(DisplayOption::TransparentText)).then_some(background))
    }

    fn print_char(&mut self, c: char) {
        match c {
            '\n' => self.new_line(self.has(DisplayOption::LineFeed)),
            '\r' => self.column = 0,
            '\t' => (0..TAB - self.column.rem_euclid(TAB)).for_each(|_| self.print_glyph(' ')),
            c if c.is_control() => {}
            c => self.print_glyph(c),
        }
    }

    /// Draws a letter at the cursor. A full line wraps before the next letter, not after its last one, so
    /// that a following newline leaves no empty row.
    fn print_glyph(&mut self, c: char) {
        let (rows, columns) = self.text_size();
        if self.column >= columns {
            self.new_line(true);
        }
        if (0..rows).contains(&self.row) && self.column >= 0 {
            let (width, height) = fonts::cell(self.face());
            let at = (self.column * width, TEXT_TOP + self.row * height);
            let (foreground, background) = self.text_colours();
            let face = self.face();
            draw_text(&mut self.canvas, c.encode_utf8(&mut [0; 4]), at, face, foreground, background);
        }
        self.column = self.column.saturating_add(1);
    }

    fn new_line(&mut self, to_the_left: bool) {
        if to_the_left {
            self.column = 0;
        }
        let (rows, _) = self.text_size();
        if self.row < rows - 1 || !self.has(DisplayOption::Scrolling) {
            self.row = self.row.saturating_add(1);
            return;
        }
        let (_, height) = fonts::cell(self.face());
        self.canvas.scroll_up(TEXT_TOP..TEXT_TOP + rows * height, height, self.background);
        self.row = rows - 1;
    }

    fn draw_menu(&mut self) {
        for (i, label) in (0..).zip(&self.labels) {
            let width = self.canvas.width() / 4;
            let (left, top) = (i * width, self.canvas.height() - Self::MENU_HEIGHT as i32);
            // The pixels to the left of and above a key separate it from its neighbours and from the text.
            self.canvas.fill(left..left + width, top..self.canvas.height(), Colour::BLACK);
            self.canvas.fill(left + 1..left + width, top + 1..self.canvas.height(), label.background);
            let face = &iso_8859_1::FONT_8X13_BOLD;
            let (letter, height) = fonts::cell(face);
            let room = (width / letter) as usize;
            let text: String = label.text.chars().filter(|c| !c.is_control()).take(room).collect();
            let at = (
                left + (width - letter * text.chars().count() as i32) / 2,
                top + (Self::MENU_HEIGHT as i32 - height) / 2,
            );
            draw_text(&mut self.canvas, &text, at, face, label.foreground, None);
        }
    }

    fn set_label(&mut self, key: Key, label: &str, foreground: Colour, background: Colour) {
        let index = Key::ALL.iter().position(|&k| k == key).unwrap_or_default();
        self.labels[index] = Label { text: label.to_owned(), foreground, background };
    }

    fn show_menu(&mut self) {
        self.switch(DisplayOption::Menu, true);
        self.draw_menu();
    }

    fn switch(&mut self, option: DisplayOption, on: bool) {
        self.options.retain(|&o| o != option);
        if on {
            self.options.push(option);
        }
    }
}

impl Display for Lcd {
    fn print(&mut self, text: &str) -> Result<()> {
        text.chars().for_each(|c| self.print_char(c));
        Ok(())
    }

    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
        (self.row, self.column) = (row, column);
        Ok(())
    }

    fn cursor(&mut self) -> Result<(i32, i32)> {
        Ok((self.row, self.column))
    }

    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
        (self.foreground, self.background) = (foreground, background);
        Ok(())
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        self.font = font;
        Ok(())
    }

    fn clear_display(&mut self) -> Result<()> {
        self.canvas.fill(0..self.canvas.width(), 0..self.canvas.height(), self.background);
        if self.has(DisplayOption::Menu) {
            self.draw_menu();
        }
        self.set_cursor(0, 0)
    }

    fn display_size(&mut self) -> Result<(i32, i32)> {
        Ok((self.canvas.width(), self.canvas.height()))
    }

    fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()> {
        self.canvas.set(at, colour);
        Ok(())
    }

    fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>> {
        Ok(self.canvas.get(at))
    }

    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
        self.canvas.line(from, to, colour);
        Ok(())
    }

    fn draw_rectangle(&mut self, corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> Result<()> {
        self.canvas.rectangle(corner, opposite, colour, fill);
        Ok(())
    }

    fn draw_circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()> {
        self.canvas.circle(centre, diameter, colour, fill);
        Ok(())
    }

    fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()> {
        self.canvas.picture(picture, viewport);
        Ok(())
    }

    fn set_menu_label(
        &mut self,
        key: Key,
        label: &str,
        foreground: Colour,
        background: Colour,
    ) -> Result<()> {
        self.set_label(key, label, foreground, background);
        self.show_menu();
        Ok(())
    }

    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
        let (foreground, background) = DEFAULT_LABEL;
        for (key, label) in Key::ALL.into_iter().zip(labels) {
            self.set_label(key, label, foreground, background);
        }
        self.show_menu();
        Ok(())
    }

    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        let was_on = self.has(option);
        self.switch(option, on);
        match (option, on) {
            (DisplayOption::AutoRefresh, true) => self.frozen = None,
            (DisplayOption::AutoRefresh, false) if was_on => self.frozen = Some(self.canvas.image().clone()),
            (DisplayOption::Menu, true) => self.draw_menu(),
            (DisplayOption::Menu, false) if was_on => {
                self.canvas.fill(
                    0..self.canvas.width(),
                    self.menu_top()..self.canvas.height(),
                    self.background,
                );
            }
            _ => {}
        }
        Ok(())
    }

    fn refresh(&mut self) -> Result<()> {
        if let Some(frozen) = &mut self.frozen {
            frozen.copy_from_slice(self.canvas.image());
        }
        Ok(())
    }

    fn screenshot(&mut self) -> Result<RgbImage> {
        Ok(self.frame().clone())
    }
}

fn inverse(colour: Colour) -> Colour {
    Colour::new(!colour.red, !colour.green, !colour.blue)
}

fn draw_text(
    canvas: &mut Canvas,
    text: &str,
    (x, y): Pixel,
    face: &MonoFont<'_>,
    foreground: Colour,
    background: Option<Colour>,
) {
    let rgb = |c: Colour| Rgb888::new(c.red, c.green, c.blue);
    let mut style = MonoTextStyleBuilder::new().font(face).text_color(rgb(foreground)).build();
    style.background_color = background.map(rgb);
    // Drawing on a canvas is infallible.
    let Ok(_) = Text::with_baseline(text, Point::new(x, y), style, Baseline::Top).draw(canvas);
}

#[cfg(test)]
mod tests;
