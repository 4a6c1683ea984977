use std::convert::Infallible;
use std::ops::Range;

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::primitives::{Line, PointsIter, Rectangle};
use image::{Rgb, RgbImage};

use crate::io::{DisplayImage, Fill, Pixel, Viewport};
use crate::world::Colour;

/// Lines are clipped to this many pixels around the origin before drawing, which bounds the time per line.
/// Clipping shifts the visible part by less than a pixel.
const GUARD: f64 = 4096.0;

/// A pixel buffer with drawing primitives. All drawing is clipped.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    image: RgbImage,
}

impl Canvas {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self { image: RgbImage::new(width, height) }
    }

    pub(super) fn image(&self) -> &RgbImage {
        &self.image
    }

    pub(super) fn width(&self) -> i32 {
        self.image.width() as i32
    }

    pub(super) fn height(&self) -> i32 {
        self.image.height() as i32
    }

    pub(super) fn set(&mut self, (x, y): Pixel, colour: Colour) {
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
            && let Some(pixel) = self.image.get_pixel_mut_checked(x, y)
        {
            *pixel = rgb(colour);
        }
    }

    pub(super) fn get(&self, (x, y): Pixel) -> Option<Colour> {
        let (x, y) = (u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        self.image.get_pixel_checked(x, y).map(|&Rgb([red, green, blue])| Colour::new(red, green, blue))
    }

    /// Fills the visible pixels of a box.
    pub(super) fn fill(&mut self, columns: Range<i32>, rows: Range<i32>, colour: Colour) {
        let columns = clip(&columns, self.width());
        let line = rgb(colour).0.repeat(columns.len());
        for y in clip(&rows, self.height()) {
            let start = 3 * (y * self.width() + columns.start) as usize;
            (*self.image)[start..start + line.len()].copy_from_slice(&line);
        }
    }

    /// Scrolls a band of rows up by `by` pixels and fills the freed rows.
    pub(super) fn scroll_up(&mut self, rows: Range<i32>, by: i32, colour: Colour) {
        let rows = clip(&rows, self.height());
        let by = by.clamp(0, (rows.end - rows.start).max(0));
        let stride = 3 * self.width() as usize;
        let byte = |row: i32| row as usize * stride;
        self.image.copy_within(byte(rows.start + by)..byte(rows.end), byte(rows.start));
        self.fill(0..self.width(), rows.end - by..rows.end, colour);
    }

    pub(super) fn line(&mut self, from: Pixel, to: Pixel, colour: Colour) {
        if let Some((from, to)) = cut_line(from, to) {
            Line::new(from, to).points().for_each(|point| self.set((point.x, point.y), colour));
        }
    }

    pub(super) fn rectangle(&mut self, a: Pixel, b: Pixel, colour: Colour, fill: Fill) {
        // Any position beyond an edge is equally invisible.
        let column = |x: i32| x.clamp(-1, self.width());
        let row = |y: i32| y.clamp(-1, self.height());
        let (left, right) = (column(a.0.min(b.0)), column(a.0.max(b.0)));
        let (top, bottom) = (row(a.1.min(b.1)), row(a.1.max(b.1)));
        if fill == Fill::Solid {
            self.fill(left..right + 1, top..bottom + 1, colour);
            return;
        }
        self.fill(left..right + 1, top..top + 1, colour);
        self.fill(left..right + 1, bottom..bottom + 1, colour);
        self.fill(left..left + 1, top..bottom + 1, colour);
        self.fill(right..right + 1, top..bottom + 1, colour);
    }

    /// Draws the same pixels as `embedded_graphics::primitives::Circle`, which overflows for large circles
    /// and visits invisible rows.
    pub(super) fn circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) {
        let outer = Disc::new(centre, diameter);
        let inner = Disc::inside(centre, diameter);
        for y in 0..self.height() {
            let Some(span) = outer.span(y) else { continue };
            let hole = if fill == Fill::Outline { inner.span(y) } else { None };
            let row = y..y + 1;
            if let Some(hole) = hole {
                self.fill(span.start..hole.start, row.clone(), colour);
                self.fill(hole.end..span.end, row, colour);
            } else {
                self.fill(span, row, colour);
            }
        }
    }

    pub(super) fn picture(&mut self, picture: DisplayImage<'_>, viewport: Viewport) {
        let Viewport { corner: (left, top), width, height } = viewport;
        let (columns, rows) = picture.dimensions();
        let visible =
            |first: i32, length: i32, limit: i32| clip(&(first..first.saturating_add(length.max(0))), limit);
        for y in visible(top, height, self.height()) {
            let source_y = nearest(y, top, height, rows);
            for x in visible(left, width, self.width()) {
                if let Some(colour) = picture.colour(nearest(x, left, width, columns), source_y) {
                    self.set((x, y), colour);
                }
            }
        }
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.image.width(), self.image.height())
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> Result<(), Self::Error>
    where
        I: IntoIterator<Item = embedded_graphics::Pixel<Self::Color>>,
    {
        for embedded_graphics::Pixel(Point { x, y }, colour) in pixels {
            self.set((x, y), Colour::new(colour.r(), colour.g(), colour.b()));
        }
        Ok(())
    }

    fn fill_solid(&mut self, area: &Rectangle, colour: Self::Color) -> Result<(), Self::Error> {
        let colour = Colour::new(colour.r(), colour.g(), colour.b());
        self.fill(area.columns(), area.rows(), colour);
        Ok(())
    }
}

fn rgb(colour: Colour) -> Rgb<u8> {
    Rgb([colour.red, colour.green, colour.blue])
}

fn clip(range: &Range<i32>, limit: i32) -> Range<i32> {
    range.start.clamp(0, limit)..range.end.clamp(0, limit)
}

/// Source pixel of a pixel in a window `length` pixels long.
fn nearest(position: i32, start: i32, length: i32, source: u32) -> u32 {
    let offset = i64::from(position) - i64::from(start);
    (offset * i64::from(source) / i64::from(length)) as u32
}

/// The part of a line within the guard band (Liang and Barsky); `None` if there is none.
fn cut_line(from: Pixel, to: Pixel) -> Option<(Point, Point)> {
    let (x, y) = (f64::from(from.0), f64::from(from.1));
    let (dx, dy) = (f64::from(to.0) - x, f64::from(to.1) - y);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (delta, room) in [(-dx, x + GUARD), (dx, GUARD - x), (-dy, y + GUARD), (dy, GUARD - y)] {
        if delta == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if delta < 0.0 {
            first = first.max(room / delta);
        } else {
            last = last.min(room / delta);
        }
    }
    let at = |t: f64| Point::new((x + t * dx).round() as i32, (y + t * dy).round() as i32);
    (first <= last).then(|| (at(first), at(last)))
}

/// A round set of pixels, in half pixels so that centres between pixels are integers.
struct Disc {
    x2: i128,
    y2: i128,
    /// Limit of the squared distance from the centre, exclusive.
    threshold: i128,
}

impl Disc {
    fn new((x, y): Pixel, diameter: i32) -> Self {
        let diameter = i128::from(diameter.max(0));
        // With an even diameter the true centre is half a pixel right of and below the centre pixel.
        let half = i128::from(diameter % 2 == 0);
        // Tiny circles look square without a correction.
        let correction = if diameter <= 4 { diameter / 2 } else { 0 };
        Self {
            x2: 2 * i128::from(x) + half,
            y2: 2 * i128::from(y) + half,
            threshold: diameter * diameter - correction,
        }
    }

    /// The area enclosed by the outline of a circle.
    fn inside(centre: Pixel, diameter: i32) -> Self {
        Self::new(centre, diameter.saturating_sub(2))
    }

    /// The columns of a row within the disc.
    fn span(&self, y: i32) -> Option<Range<i32>> {
        let dy = 2 * i128::from(y) - self.y2;
        let room = self.threshold - dy * dy;
        if room <= 0 {
            return None;
        }
        let reach = (room - 1).isqrt();
        let first = (self.x2 - reach + 1).div_euclid(2);
        let last = (self.x2 + reach).div_euclid(2);
        let column = |x: i128| x.clamp(i128::from(i32::MIN), i128::from(i32::MAX)) as i32;
        (first <= last).then(|| column(first)..column(last + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_graphics::Drawable;
    use embedded_graphics::primitives::{Circle, Primitive, PrimitiveStyle};
    use proptest::prelude::*;

    fn canvas() -> Canvas {
        Canvas::new(64, 48)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn circles_are_those_of_embedded_graphics(
            x in -10..74i32, y in -10..58i32, diameter in 0..90i32, solid: bool,
        ) {
            let (mut ours, mut theirs) = (canvas(), canvas());
            ours.circle((x, y), diameter, Colour::WHITE, if solid { Fill::Solid } else { Fill::Outline });
            let style = if solid {
                PrimitiveStyle::with_fill(Rgb888::WHITE)
            } else {
                PrimitiveStyle::with_stroke(Rgb888::WHITE, 1)
            };
            Circle::with_center(Point::new(x, y), diameter as u32).into_styled(style).draw(&mut theirs).unwrap();
            prop_assert_eq!(ours.image(), theirs.image());
        }

        #[test]
        fn cutting_leaves_near_lines_alone(
            a in (-4000..4000i32, -4000..4000i32), b in (-4000..4000i32, -4000..4000i32),
        ) {
            let (from, to) = cut_line(a, b).unwrap();
            prop_assert_eq!(((from.x, from.y), (to.x, to.y)), (a, b));
        }

        #[test]
        fn far_lines_stay_within_a_pixel_of_where_they_belong(
            a in (-2_000_000_000..2_000_000_000i32, -2_000_000_000..2_000_000_000i32), b in (0..64i32, 0..48i32),
        ) {
            let mut drawn = canvas();
            drawn.line(a, b, Colour::WHITE);
            prop_assert_eq!(drawn.get(b), Some(Colour::WHITE));
            let (dx, dy) = (f64::from(b.0) - f64::from(a.0), f64::from(b.1) - f64::from(a.1));
            let length = (dx * dx + dy * dy).sqrt();
            for (x, y, pixel) in drawn.image().enumerate_pixels() {
                if pixel.0 != [0; 3] {
                    let (px, py) = (f64::from(x) - f64::from(b.0), f64::from(y) - f64::from(b.1));
                    prop_assert!(((px * dy - py * dx) / length).abs() < 1.0, "{x} {y}");
                }
            }
        }

        #[test]
        fn a_rectangle_has_the_pixels_between_its_corners(
            a in (-9..70i32, -9..60i32), b in (-9..70i32, -9..60i32), solid: bool,
        ) {
            let mut drawn = canvas();
            drawn.rectangle(a, b, Colour::RED, if solid { Fill::Solid } else { Fill::Outline });
            let (left, right) = (a.0.min(b.0), a.0.max(b.0));
            let (top, bottom) = (a.1.min(b.1), a.1.max(b.1));
            for (x, y, pixel) in drawn.image().enumerate_pixels() {
                let (x, y) = (x as i32, y as i32);
                let within = (left..=right).contains(&x) && (top..=bottom).contains(&y);
                let border = x == left || x == right || y == top || y == bottom;
                prop_assert_eq!(pixel.0 == [255, 0, 0], within && (solid || border), "{} {}", x, y);
            }
        }
    }

    #[test]
    fn a_line_far_off_the_canvas_draws_nothing() {
        let mut drawn = canvas();
        drawn.line((i32::MAX, 0), (i32::MAX, 48), Colour::WHITE);
        drawn.line((i32::MIN, i32::MAX), (i32::MAX, i32::MAX), Colour::WHITE);
        assert_eq!(drawn.image(), canvas().image());
    }

    #[test]
    fn a_giant_circle_still_crosses_the_canvas() {
        let mut drawn = canvas();
        // The circle's right edge lies on column 20.
        drawn.circle((20 - 1_000_000_000, 24), 2_000_000_001, Colour::WHITE, Fill::Outline);
        let lit: Vec<_> = drawn.image().enumerate_pixels().filter(|(.., p)| p.0 != [0; 3]).collect();
        assert_eq!(lit.len(), 48);
        assert!(lit.iter().all(|&(x, ..)| x == 20));
    }

    #[test]
    fn pictures_scale_by_the_nearest_pixel() {
        let source = RgbImage::from_fn(2, 1, |x, _| Rgb([10 * x as u8 + 1; 3]));
        let mut drawn = canvas();
        drawn.picture(DisplayImage::Rgb(&source), Viewport::new((10, 10), 6, 2));
        for (x, value) in [(9, 0), (10, 1), (12, 1), (13, 11), (15, 11), (16, 0)] {
            assert_eq!(drawn.get((x, 11)), Some(Colour::new(value, value, value)), "{x}");
        }
        assert_eq!(drawn.get((10, 12)), Some(Colour::BLACK));
    }
}
