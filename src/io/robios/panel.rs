//! Display and keys of the robot.

use std::ffi::{CString, c_int};

use image::RgbImage;

use super::call::{call, order};
use super::robot::RobiosRobot;
use crate::io::{
    Display, DisplayImage, DisplayOption, Error, ErrorKind, Fill, Font, FontFamily, FontStyle, Key, Keys,
    Pixel, Resolution, Result, Viewport,
};
use crate::world::Colour;

/// RoBIOS's numbers of the soft keys.
const KEYS: [(c_int, Key); 4] = [(1, Key::Key1), (2, Key::Key2), (4, Key::Key3), (8, Key::Key4)];

/// A text as a C string, up to its first zero byte.
fn text(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

fn number(colour: Colour) -> c_int {
    c_int::from(colour.red) << 16 | c_int::from(colour.green) << 8 | c_int::from(colour.blue)
}

fn fills(fill: Fill) -> c_int {
    c_int::from(fill == Fill::Solid)
}

impl Display for RobiosRobot {
    fn print(&mut self, line: &str) -> Result<()> {
        let line = text(line);
        order!(self, LCDPrintf(c"%s".as_ptr(), line.as_ptr()))
    }

    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
        order!(self, LCDSetPos(row, column))
    }

    fn cursor(&mut self) -> Result<(i32, i32)> {
        let (mut row, mut column) = (0, 0);
        order!(self, LCDGetPos(&raw mut row, &raw mut column))?;
        Ok((row, column))
    }

    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
        order!(self, LCDSetColor(number(foreground), number(background)))
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        let family = match font.family {
            FontFamily::Helvetica => 0,
            FontFamily::Times => 1,
            FontFamily::Courier => 2,
        };
        let style = match font.style {
            FontStyle::Normal => 0,
            FontStyle::Bold => 1,
            FontStyle::Italic => 2,
        };
        order!(self, LCDSetFont(family, style))?;
        order!(self, LCDSetFontSize(font.size))
    }

    fn clear_display(&mut self) -> Result<()> {
        order!(self, LCDClear())
    }

    fn display_size(&mut self) -> Result<(i32, i32)> {
        let (mut width, mut height) = (0, 0);
        order!(self, LCDGetSize(&raw mut width, &raw mut height))?;
        Ok((width, height))
    }

    fn set_pixel(&mut self, (x, y): Pixel, colour: Colour) -> Result<()> {
        order!(self, LCDPixel(x, y, number(colour)))
    }

    /// RoBIOS returns black for pixels outside the display.
    fn pixel(&mut self, (x, y): Pixel) -> Result<Option<Colour>> {
        Ok(Some(Colour::from_hex(call!(self, LCDGetPixel(x, y)) as u32)))
    }

    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
        order!(self, LCDLine(from.0, from.1, to.0, to.1, number(colour)))
    }

    fn draw_rectangle(&mut self, from: Pixel, to: Pixel, colour: Colour, fill: Fill) -> Result<()> {
        order!(self, LCDArea(from.0, from.1, to.0, to.1, number(colour), fills(fill)))
    }

    fn draw_circle(&mut self, middle: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()> {
        order!(self, LCDCircle(middle.0, middle.1, diameter, number(colour), fills(fill)))
    }

    /// Fails for images of a size that RoBIOS lacks.
    fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()> {
        let resolution = Resolution::of(picture.dimensions())?;
        let size = Resolution::ALL.iter().position(|&r| r == resolution).unwrap_or_default();
        order!(self, LCDImageSize(size as c_int))?;
        let Viewport { corner: (x, y), width, height } = viewport;
        order!(self, LCDImageStart(x, y, width, height))?;
        match picture {
            DisplayImage::Rgb(image) => order!(self, LCDImage(image.as_raw().as_ptr())),
            DisplayImage::Gray(image) => order!(self, LCDImageGray(image.as_raw().as_ptr())),
            DisplayImage::Binary(image) => order!(self, LCDImageBinary(image.as_raw().as_ptr())),
        }
    }

    fn set_menu_label(
        &mut self,
        key: Key,
        label: &str,
        foreground: Colour,
        background: Colour,
    ) -> Result<()> {
        let place = Key::ALL.iter().position(|&k| k == key).unwrap_or_default() as c_int + 1;
        let label = text(label);
        order!(self, LCDMenuI(place, label.as_ptr(), number(foreground), number(background)))
    }

    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
        let labels = labels.map(text);
        let [first, second, third, fourth] = labels.each_ref().map(|label| label.as_ptr());
        order!(self, LCDMenu(first, second, third, fourth))
    }

    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        let (switch_on, switch_off) = match option {
            DisplayOption::AutoRefresh => (0x0001, 0x0100),
            DisplayOption::Scrolling => (0x0002, 0x0200),
            DisplayOption::LineFeed => (0x0004, 0x0400),
            DisplayOption::Menu => (0x0008, 0x0800),
            DisplayOption::TransparentText => (0x01_0000, 0x10_0000),
            DisplayOption::InvertedBackground => (0x02_0000, 0x20_0000),
            DisplayOption::InvertedForeground => (0x04_0000, 0x40_0000),
        };
        order!(self, LCDSetMode(if on { switch_on } else { switch_off }))
    }

    fn refresh(&mut self) -> Result<()> {
        order!(self, LCDRefresh())
    }

    /// RoBIOS cannot read the whole display.
    fn screenshot(&mut self) -> Result<RgbImage> {
        Err(Error::unsupported("way to read its display"))
    }
}

fn key(number: c_int) -> Option<Key> {
    KEYS.into_iter().find(|(code, _)| number & code != 0).map(|(_, key)| key)
}

impl Keys for RobiosRobot {
    fn read_key(&mut self) -> Result<Option<Key>> {
        Ok(key(call!(self, KEYRead())))
    }

    fn wait_key(&mut self) -> Result<Key> {
        let number = call!(self, KEYGet());
        key(number)
            .ok_or_else(|| Error::new(ErrorKind::Other, format!("KEYGet returned {number}, which is no key")))
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        let (mut x, mut y) = (0, 0);
        let code = call!(self, KEYReadXY(&raw mut x, &raw mut y));
        Ok((code == 0).then_some((x, y)))
    }
}
