use crate::geometry::{Aabb, Point, Vector};

/// Pixels round the plot, from it to the legend, and from entry to entry there.
pub(super) const GAP: f64 = 20.0;

/// A point of the picture in pixels: x to the right, y down.
pub(super) type Pixel = nalgebra::Point2<f64>;

/// The region of the world shown by a picture, and its position on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    /// Region of the world (m).
    pub(super) region: Aabb,
    /// Pixels per metre.
    pub(super) scale: f64,
    /// Pixel of the region's upper left corner.
    pub(super) corner: Pixel,
}

impl Frame {
    /// Pixels of the plot's width at most.
    pub(super) const WIDEST: f64 = 560.0;
    /// Pixels of the plot's height at most.
    pub(super) const TALLEST: f64 = 480.0;
    /// Minimum height of a drawn region, relative to its longer side.
    const FLATTEST: f64 = 0.06;

    /// The largest frame that shows `region` within the room for the plot.
    pub(super) fn around(region: Aabb, corner: Pixel) -> Self {
        let region = presentable(region);
        let size = region.size();
        let scale = (Self::WIDEST / size.x).min(Self::TALLEST / size.y);
        Self { region, scale, corner }
    }

    /// Pixel of a point of the world.
    pub(super) fn at(&self, point: Point) -> Pixel {
        let (left, top) = (self.region.min.x, self.region.max.y);
        self.corner + Vector::new(point.x - left, top - point.y) * self.scale
    }

    /// The same for a world that is drawn shifted by so many metres.
    pub(super) fn shifted(&self, shift: Vector) -> Self {
        Self { corner: self.corner + Vector::new(shift.x, -shift.y) * self.scale, ..*self }
    }

    /// Metres to pixels.
    pub(super) fn length(&self, metres: f64) -> f64 {
        metres * self.scale
    }

    /// The frame's outline on the page.
    pub(super) fn pixels(&self) -> Aabb {
        Aabb { min: self.corner, max: self.corner + self.region.size() * self.scale }
    }

    /// Distance of the grid lines and length of the scale bar (m): 1, 2 or 5 times a power of ten, and at
    /// least 56 pixels where the frame is wide enough.
    pub(super) fn grid_step(&self) -> f64 {
        let least = (56.0 / self.scale).min(0.5 * self.region.size().x);
        let powers = (-9..12).map(|exponent| crate::geometry::math::pow(10.0, f64::from(exponent)));
        let steps = powers.flat_map(|power| [power, 2.0 * power, 5.0 * power]);
        steps.into_iter().find(|step| *step >= least).unwrap_or(least)
    }
}

/// A region that can be drawn: finite, not empty, not too flat.
fn presentable(region: Aabb) -> Aabb {
    let finite = [region.min, region.max].iter().all(|p| p.x.abs() < 1e9 && p.y.abs() < 1e9);
    if !finite {
        return Aabb::new(Point::origin(), Point::new(1.0, 1.0));
    }
    let size = region.size();
    let longest = size.x.max(size.y);
    if longest <= 1e-9 {
        return region.inflated(0.5);
    }
    let missing = |length: f64| 0.5 * (Frame::FLATTEST * longest - length).max(0.0);
    let grow = Vector::new(missing(size.x), missing(size.y));
    Aabb { min: region.min - grow, max: region.max + grow }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn any_world_fits_the_room(width in 0.0..400.0f64, height in 0.0..400.0f64, x in -50.0..50.0) {
            let corner = Pixel::new(30.0, 60.0);
            let region = Aabb::new(Point::new(x, 0.0), Point::new(x + width, height));
            let frame = Frame::around(region, corner);
            let size = frame.pixels().size();
            prop_assert!(size.x <= Frame::WIDEST + 1e-6 && size.y <= Frame::TALLEST + 1e-6);
            prop_assert!(size.x >= 28.0 && size.y >= 28.0);
            for point in [region.min, region.max] {
                prop_assert!(frame.pixels().inflated(1e-6).contains(frame.at(point)));
            }
        }

        #[test]
        fn north_is_up(y in 0.0..1.0f64) {
            let frame = Frame::around(Aabb::new(Point::origin(), Point::new(1.0, 2.0)), Pixel::origin());
            prop_assert!(frame.at(Point::new(0.5, y + 0.1)).y < frame.at(Point::new(0.5, y)).y);
        }

        #[test]
        fn the_grid_is_readable(side in 0.01..500.0f64) {
            let frame = Frame::around(Aabb::new(Point::origin(), Point::new(side, side)), Pixel::origin());
            let pixels = frame.length(frame.grid_step());
            prop_assert!((56.0 - 1e-6..=140.0 + 1e-6).contains(&pixels), "{pixels} pixels");
        }
    }

    #[test]
    fn worlds_without_extent_are_drawn() {
        for region in [
            Aabb::new(Point::new(3.0, 4.0), Point::new(3.0, 4.0)),
            Aabb { min: Point::new(f64::NAN, 0.0), max: Point::new(1.0, 1.0) },
            Aabb { min: Point::new(0.0, 0.0), max: Point::new(f64::INFINITY, 1.0) },
        ] {
            let frame = Frame::around(region, Pixel::origin());
            assert!(frame.scale.is_finite() && frame.scale > 0.0, "{region:?}");
        }
    }
}
