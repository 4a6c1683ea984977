use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::ascii::FONT_10X20;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{Drawable, Pixel};
use embedded_graphics::text::{Baseline, Text};

/// A word in block letters, as a shape.
#[derive(Debug)]
pub(super) struct Word {
    size: Size,
    ink: Vec<bool>,
}

impl Word {
    pub(super) fn new(word: &str) -> Self {
        // Letters of the font are 13 pixels high, 3 below the upper edge.
        let size = Size::new(10 * word.len() as u32, 20);
        let mut written = Self { size, ink: vec![false; (size.width * size.height) as usize] };
        let style = MonoTextStyle::new(&FONT_10X20, BinaryColor::On);
        let text = Text::with_baseline(word, Point::zero(), style, Baseline::Top);
        // This drawing target cannot fail.
        let Ok(_) = text.draw(&mut written);
        written
    }

    /// Whether there is ink at a point; coordinates are from -1 to 1 across the word, and from -1 above to 1
    /// below its capitals.
    pub(super) fn covers(&self, x: f64, y: f64) -> bool {
        let (column, row) = (0.5 * (x + 1.0) * f64::from(self.size.width), 3.0 + 0.5 * (y + 1.0) * 13.0);
        let inside = (0.0..f64::from(self.size.width)).contains(&column) && (0.0..20.0).contains(&row);
        inside && self.ink[row as usize * self.size.width as usize + column as usize]
    }
}

impl OriginDimensions for Word {
    fn size(&self) -> Size {
        self.size
    }
}

impl DrawTarget for Word {
    type Color = BinaryColor;
    type Error = std::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Self::Error> {
        for Pixel(place, colour) in pixels {
            let (column, row) = (place.x as usize, place.y as usize);
            if column < self.size.width as usize && row < self.size.height as usize {
                self.ink[row * self.size.width as usize + column] = colour.is_on();
            }
        }
        Ok(())
    }
}
