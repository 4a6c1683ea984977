use image::{GrayImage, RgbImage};
use roverlab::io::sim::Lcd;
use roverlab::io::{
    Display, DisplayImage, DisplayOption, Fill, Font, FontFamily, FontStyle, Key, Result, Viewport,
};

use super::{ImageSize, Robios, images, invalid};
use crate::keys::{KEYS, Waiting};
use crate::screen::{colour, number};

/// Default size of images for the display: QVGA.
const DEFAULT_IMAGE: (usize, usize) = (320, 240);
/// Maximum number of columns and rows of an image window.
const WIDEST: i32 = 10_000;
/// RoBIOS's number for images of a custom size.
const CUSTOM: i32 = 10;

/// Display settings: bits that switch them on and off.
const MODES: [(i32, i32, DisplayOption); 7] = [
    (0x01_0000, 0x10_0000, DisplayOption::TransparentText),
    (0x02_0000, 0x20_0000, DisplayOption::InvertedBackground),
    (0x04_0000, 0x40_0000, DisplayOption::InvertedForeground),
    (0x0001, 0x0100, DisplayOption::AutoRefresh),
    (0x0002, 0x0200, DisplayOption::Scrolling),
    (0x0004, 0x0400, DisplayOption::LineFeed),
    (0x0008, 0x0800, DisplayOption::Menu),
];

/// An image for the display.
#[derive(Debug)]
pub enum Frame {
    /// RGB, three bytes per pixel.
    Colour(Vec<u8>),
    /// Grayscale, one byte per pixel.
    Gray(Vec<u8>),
    /// Binary, one byte per pixel, 0 for white.
    Binary(Vec<u8>),
}

impl Robios {
    /// `LCDPrintf`, formatted.
    pub fn lcd_print(&mut self, text: &str) -> Result<()> {
        self.text_changed = true;
        if self.keys.is_live() {
            // The user at the terminal has no other display.
            eprint!("{text}");
        }
        self.screen.print(text)?;
        self.charge()
    }

    /// `LCDSetPrintf`, formatted.
    pub fn lcd_print_at(&mut self, row: i32, column: i32, text: &str) -> Result<()> {
        self.screen.lcd.set_cursor(row, column)?;
        self.lcd_print(text)
    }

    /// `LCDClear`.
    pub fn lcd_clear(&mut self) -> Result<()> {
        self.text_changed = true;
        self.screen.clear()?;
        self.charge()
    }

    /// `LCDSetPos`.
    pub fn lcd_set_pos(&mut self, row: i32, column: i32) -> Result<()> {
        self.screen.lcd.set_cursor(row, column)?;
        self.charge()
    }

    /// `LCDGetPos`.
    pub fn lcd_get_pos(&mut self) -> Result<(i32, i32)> {
        self.charge()?;
        self.screen.lcd.cursor()
    }

    /// `LCDSetColor`.
    pub fn lcd_set_color(&mut self, foreground: i32, background: i32) -> Result<()> {
        self.screen.lcd.set_text_colours(colour(foreground), colour(background))?;
        self.charge()
    }

    /// `LCDSetFont`.
    pub fn lcd_set_font(&mut self, family: i32, style: i32) -> Result<()> {
        let family = match family {
            0 => FontFamily::Helvetica,
            1 => FontFamily::Times,
            2 => FontFamily::Courier,
            _ => return Err(invalid("font", family, "0 to 2")),
        };
        let style = match style {
            0 => FontStyle::Normal,
            1 => FontStyle::Bold,
            2 => FontStyle::Italic,
            _ => return Err(invalid("font variation", style, "0 to 2")),
        };
        self.set_font(Font { family, style, ..self.screen.font })
    }

    /// `LCDSetFontSize`.
    pub fn lcd_set_font_size(&mut self, size: i32) -> Result<()> {
        self.set_font(Font { size, ..self.screen.font })
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        self.screen.font = font;
        self.screen.lcd.set_font(font)?;
        self.charge()
    }

    /// `LCDSetMode`: 0 restores the defaults. Unsupported settings are ignored, with a note.
    pub fn lcd_set_mode(&mut self, mode: i32) -> Result<()> {
        let known = MODES.iter().fold(0, |bits, (on, off, _)| bits | on | off);
        if mode & !known != 0 {
            self.note(&format!("the settings {:#x} of the display have no effect", mode & !known));
        }
        for (on, off, option) in MODES {
            let initially = [DisplayOption::AutoRefresh, DisplayOption::Scrolling, DisplayOption::LineFeed];
            if mode == 0 && option != DisplayOption::Menu {
                self.screen.switch(option, initially.contains(&option))?;
            } else if mode & on != 0 {
                self.screen.switch(option, true)?;
            } else if mode & off != 0 {
                self.screen.switch(option, false)?;
            }
        }
        self.charge()
    }

    /// `LCDMenu`.
    pub fn lcd_menu(&mut self, labels: [String; 4]) -> Result<()> {
        self.screen.lcd.set_menu(labels.each_ref().map(String::as_str))?;
        if self.keys.is_live() && *self.keys.labels() != labels {
            let [first, second, third, fourth] = &labels;
            eprintln!("\n[1] {first}  [2] {second}  [3] {third}  [4] {fourth}");
        }
        self.keys.label(labels);
        self.charge()
    }

    /// `LCDMenuI`, with keys numbered from 1.
    pub fn lcd_menu_i(&mut self, key: i32, label: &str, foreground: i32, background: i32) -> Result<()> {
        let index = usize::try_from(key).ok().and_then(|key| key.checked_sub(1)).filter(|&index| index < 4);
        let index = index.ok_or_else(|| invalid("key", key, "1 to 4"))?;
        let mut labels = self.keys.labels().clone();
        label.clone_into(&mut labels[index]);
        self.keys.label(labels);
        self.screen.lcd.set_menu_label(Key::ALL[index], label, colour(foreground), colour(background))?;
        self.charge()
    }

    /// `LCDGetSize`.
    pub fn lcd_get_size(&mut self) -> Result<(i32, i32)> {
        self.charge()?;
        self.screen.lcd.display_size()
    }

    /// `LCDPixel`.
    pub fn lcd_pixel(&mut self, x: i32, y: i32, col: i32) -> Result<()> {
        self.screen.lcd.set_pixel((x, y), colour(col))?;
        self.charge()
    }

    /// `LCDGetPixel`.
    pub fn lcd_get_pixel(&mut self, x: i32, y: i32) -> Result<i32> {
        self.charge()?;
        let found = self.screen.lcd.pixel((x, y))?;
        found.map(number).ok_or_else(|| invalid("pixel", format!("{x}, {y}"), "one on the display"))
    }

    /// `LCDLine`.
    pub fn lcd_line(&mut self, from: (i32, i32), to: (i32, i32), col: i32) -> Result<()> {
        self.screen.lcd.draw_line(from, to, colour(col))?;
        self.charge()
    }

    /// `LCDArea`.
    pub fn lcd_area(&mut self, from: (i32, i32), to: (i32, i32), col: i32, fill: bool) -> Result<()> {
        self.screen.lcd.draw_rectangle(from, to, colour(col), filled(fill))?;
        self.charge()
    }

    /// `LCDCircle`; the size is the diameter.
    pub fn lcd_circle(&mut self, middle: (i32, i32), size: i32, col: i32, fill: bool) -> Result<()> {
        self.screen.lcd.draw_circle(middle, size, colour(col), filled(fill))?;
        self.charge()
    }

    /// `LCDPixelInvert`; also `LCDAreaInvert` and `LCDLineInvert`, pixel by pixel.
    pub fn lcd_invert(&mut self, pixels: impl IntoIterator<Item = (i32, i32)>) -> Result<()> {
        for place in pixels {
            if let Some(found) = self.screen.lcd.pixel(place)? {
                self.screen.lcd.set_pixel(place, colour(!number(found)))?;
            }
        }
        self.charge()
    }

    /// `LCDImageSize`.
    pub fn lcd_image_size(&mut self, resolution: i32) -> Result<()> {
        self.lcd_image = match resolution {
            CUSTOM => ImageSize::Custom,
            named => ImageSize::Named(images::named_size(named)?),
        };
        self.charge()
    }

    /// `LCDImageStart`.
    pub fn lcd_image_start(&mut self, corner: (i32, i32), width: i32, height: i32) -> Result<()> {
        if !(1..=WIDEST).contains(&width) || !(1..=WIDEST).contains(&height) {
            return Err(invalid("image size", format!("{width} x {height}"), "1 to 10000 columns and rows"));
        }
        self.window = Some(Viewport::new(corner, width, height));
        self.charge()
    }

    /// Size of the display's images: as set by `LCDImageSize`, or else by the camera and the image processing
    /// functions, or else by `LCDImageStart`, or else QVGA.
    pub fn lcd_image_dimensions(&self) -> (usize, usize) {
        let window =
            self.window.map_or(DEFAULT_IMAGE, |w| (w.width.max(0) as usize, w.height.max(0) as usize));
        match self.lcd_image {
            ImageSize::Named(size) => size,
            ImageSize::Unsaid if self.image_size_set => self.image_size,
            ImageSize::Unsaid | ImageSize::Custom => window,
        }
    }

    /// `LCDImage`, `LCDImageGray` and `LCDImageBinary`.
    pub fn lcd_image(&mut self, frame: Frame) -> Result<()> {
        let (width, height) = self.lcd_image_dimensions();
        let window = self.window.unwrap_or_else(|| fitting(width, height));
        let (w, h) = (width as u32, height as u32);
        let short = || invalid("image", "too short", "as many bytes as it has pixels");
        match frame {
            Frame::Colour(data) => {
                let image = RgbImage::from_raw(w, h, data).ok_or_else(short)?;
                self.screen.lcd.draw_image(DisplayImage::Rgb(&image), window)?;
            }
            Frame::Gray(data) => {
                let image = GrayImage::from_raw(w, h, data).ok_or_else(short)?;
                self.screen.lcd.draw_image(DisplayImage::Gray(&image), window)?;
            }
            Frame::Binary(data) => {
                let image = GrayImage::from_raw(w, h, data).ok_or_else(short)?;
                self.screen.lcd.draw_image(DisplayImage::Binary(&image), window)?;
            }
        }
        self.charge_image(width * height)
    }

    /// `LCDRefresh`.
    pub fn lcd_refresh(&mut self) -> Result<()> {
        self.screen.lcd.refresh()?;
        self.charge()
    }

    /// `KEYRead`: a key's number, or 0.
    pub fn key_read(&mut self) -> Result<i32> {
        self.charge()?;
        let standing = if self.keys.watches_robot() { self.standing_since()? } else { 0.0 };
        let limit = self.identity.time_limit;
        let now = self.now();
        Ok(self.keys.read(now, standing, limit).unwrap_or(0) as i32)
    }

    /// Waits for one of the keys in a mask.
    pub fn key_wait(&mut self, mask: u32) -> Result<Waiting<u32>> {
        self.charge()?;
        let now = self.now();
        let all = KEYS.iter().sum::<u32>();
        Ok(self.keys.wait(now, mask & all))
    }

    /// `KEYReadXY`.
    pub fn key_read_xy(&mut self) -> Result<Option<(i32, i32)>> {
        self.charge()?;
        let now = self.now();
        Ok(self.keys.read_touch(now))
    }

    /// Waits for a touch of the display.
    pub fn key_wait_xy(&mut self) -> Result<Waiting<(i32, i32)>> {
        self.charge()?;
        let now = self.now();
        let middle = (Lcd::WIDTH as i32 / 2, Lcd::HEIGHT as i32 / 2);
        Ok(self.keys.wait_touch(now, middle))
    }

    /// `IRTVRead`.
    pub fn irtv_read(&mut self) -> Result<i32> {
        self.charge()?;
        let now = self.now();
        Ok(self.keys.read_remote(now).unwrap_or(0))
    }

    /// Waits for the remote control.
    pub fn irtv_wait(&mut self) -> Result<Waiting<i32>> {
        self.charge()?;
        let now = self.now();
        Ok(self.keys.wait_remote(now))
    }
}

fn filled(fill: bool) -> Fill {
    if fill { Fill::Solid } else { Fill::Outline }
}

/// Default window of an image: its own size in the upper left corner, or that of QVGA if it is larger than
/// the display.
fn fitting(width: usize, height: usize) -> Viewport {
    if width <= Lcd::WIDTH as usize && height <= Lcd::HEIGHT as usize {
        Viewport::new((0, 0), width as i32, height as i32)
    } else {
        Viewport::default()
    }
}
