use super::canvas::{Canvas, Packed};
use super::relief::Rays;
use super::view::View;
use crate::geometry::math;
use crate::world::World;

/// Effect of water on a picture: it absorbs red first, veils distant things, and is darker below.
///
/// Light from above and light to the camera fade exponentially; light scattered by the water on the way is added
/// (Jaffe's model, in the form of Schechner and Karpel, *Recovery of underwater visibility and structure by
/// polarization analysis*, 2005).
#[derive(Debug, Clone, Copy)]
pub(super) struct Murk {
    level: f64,
    /// Absorption of red, green and blue per metre of water (1/m).
    absorbed: [f64; 3],
    /// What it scatters (1/m).
    scattered: f64,
}

/// Absorption of pure water at 620, 530 and 460 nm (1/m; Pope and Fry, *Applied Optics* 36, 1997).
const PURE: [f64; 3] = [0.276, 0.043, 0.0098];
/// The share of scattered light that goes on downwards nearly as it came: it lights the ground, but shows nothing.
const FORWARD: f64 = 0.9;
/// The brightness of endless water, seen through what only scatters, in levels: it sends back a tenth of the light.
const VEIL: f64 = 25.0;

impl Murk {
    /// The water of a world; `None` without any.
    pub(super) fn of(world: &World) -> Option<Self> {
        let scattered = world.water.turbidity;
        world.water_level.map(|level| Self { level, absorbed: PURE, scattered })
    }

    /// Changes a finished picture of a camera.
    pub(super) fn veil(&self, canvas: &mut Canvas, view: &View) {
        let (rays, width, eye) = (Rays::of(view), canvas.width, view.eye[2]);
        let veil = self.endless((self.level - eye).max(0.0));
        for (at, (colour, &near)) in canvas.colours.iter_mut().zip(&canvas.nearness).enumerate() {
            let ray = rays.direction(at % width, at / width);
            // The picture does not say how far the level floor is, nor the sky.
            let depth = if near > 0.0 {
                1.0 / f64::from(near)
            } else if ray[2] < 0.0 {
                eye.max(0.0) / -ray[2]
            } else {
                f64::INFINITY
            };
            let wet = self.wet(eye, ray[2], depth);
            if wet > 0.0 {
                let length = math::hypot(math::hypot(ray[0], ray[1]), ray[2]);
                let below = if depth.is_finite() { self.level - eye - ray[2] * depth } else { 0.0 };
                *colour = self.seen(*colour, wet * length, below.max(0.0), veil);
            }
        }
    }

    /// How much of a line of sight, which rises by so much per metre of depth, is in the water.
    fn wet(&self, eye: f64, rise: f64, depth: f64) -> f64 {
        let below = self.level - eye;
        if rise == 0.0 {
            return if below > 0.0 { depth } else { 0.0 };
        }
        let surface = (below / rise).max(0.0);
        match (rise > 0.0, below > 0.0) {
            (true, true) => depth.min(surface),
            (true, false) => 0.0,
            (false, _) => (depth - surface).max(0.0),
        }
    }

    /// The levels of endless water at a depth.
    fn endless(&self, depth: f64) -> [f64; 3] {
        self.absorbed.map(|absorbed| {
            let share = self.scattered / (absorbed + self.scattered);
            VEIL * share * math::exp(-self.down(absorbed) * depth)
        })
    }

    /// What a metre takes of the light from above (1/m).
    fn down(&self, absorbed: f64) -> f64 {
        absorbed + (1.0 - FORWARD) * self.scattered
    }

    /// A colour at a depth seen through so many metres of water, which veils it.
    fn seen(&self, colour: Packed, way: f64, depth: f64, veil: [f64; 3]) -> Packed {
        let mut seen = 0;
        for ((shift, absorbed), veil) in [16, 8, 0].into_iter().zip(self.absorbed).zip(veil) {
            let there = f64::from(colour >> shift & 255) * math::exp(-self.down(absorbed) * depth);
            let through = math::exp(-(absorbed + self.scattered) * way);
            let level = there * through + veil * (1.0 - through);
            seen |= ((level.min(255.0) + 0.5) as Packed) << shift;
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn murk(turbidity: f64) -> Murk {
        Murk { level: 2.0, absorbed: PURE, scattered: turbidity }
    }

    fn seen(turbidity: f64, colour: Packed, way: f64, depth: f64) -> [u32; 3] {
        let murk = murk(turbidity);
        let seen = murk.seen(colour, way, depth, murk.endless(0.5));
        [seen >> 16 & 255, seen >> 8 & 255, seen & 255]
    }

    #[test]
    fn water_takes_red_first_and_more_of_it_deeper_and_farther() {
        let [red, green, blue] = seen(0.0, 0xff_ff_ff, 2.0, 1.0);
        assert!(red < green && green < blue && red < 130, "{red} {green} {blue}");
        assert!(seen(0.0, 0xff_ff_ff, 3.0, 1.0)[0] < red && seen(0.0, 0xff_ff_ff, 2.0, 2.0)[0] < red);
    }

    #[test]
    fn turbid_water_hides_what_is_far() {
        let contrast = |turbidity| seen(turbidity, 0xff_ff_ff, 2.0, 1.5)[1] - seen(turbidity, 0, 2.0, 1.5)[1];
        assert!(contrast(0.2) > contrast(0.5) && contrast(0.5) > 2 * contrast(1.5));
        assert!(seen(1.0, 0, 1e9, 1.0)[2] > 15, "the veil");
    }

    #[test]
    fn only_the_wet_part_of_a_line_of_sight_counts() {
        let wet = |eye, rise, depth| murk(0.1).wet(eye, rise, depth);
        assert_eq!((wet(1.0, -0.5, 2.0), wet(3.0, 1.0, 9.0), wet(3.0, 0.0, 9.0)), (2.0, 0.0, 0.0));
        assert!((wet(1.0, 0.5, f64::INFINITY) - 2.0).abs() < 1e-12);
        assert!((wet(5.0, -1.0, 4.0) - 1.0).abs() < 1e-12);
    }
}
