use super::canvas::{Canvas, Packed};
use super::relief::Rays;
use super::view::View;
use crate::geometry::math;
use crate::world::World;

/// Effect of water on a picture: it absorbs red first, veils distant things, and is darker below.
///
/// Light from above and light to the camera fade exponentially; light scattered by the water on the way is
/// added (Jaffe's model, in the form of Schechner and Karpel, *Recovery of underwater visibility and
/// structure by polarization analysis*, 2005).
#[derive(Debug, Clone)]
pub(super) struct Murk {
    level: f64,
    /// Absorption of red, green and blue per metre of water (1/m).
    absorbed: [f64; 3],
    /// What it scatters (1/m).
    scattered: f64,
    /// Of light from above, by the depth, and of that on the way to the camera, by its length.
    down: Fading,
    along: Fading,
}

/// What is left of red, green and blue light after some metres of water.
#[derive(Debug, Clone)]
struct Fading {
    /// What a metre takes (1/m).
    rates: [f64; 3],
    /// At multiples of a step, of which a metre has so many.
    table: Vec<[f64; 3]>,
    per_metre: f64,
}

/// Steps of a table within which the colour that fades fastest fades to 1/e: a mean between two of them is
/// off by a hundredth of a level.
const STEPS: f64 = 64.0;
/// Entries of a table; what is farther is computed.
const ENTRIES: u32 = 2048;

/// Absorption of pure water at 620, 530 and 460 nm (1/m; Pope and Fry, *Applied Optics* 36, 1997).
const PURE: [f64; 3] = [0.276, 0.043, 0.0098];
/// The share of scattered light that goes on downwards nearly as it came: it lights the ground, but shows
/// nothing.
const FORWARD: f64 = 0.9;
/// The brightness of endless water, seen through what only scatters, in levels: it sends back a tenth of the
/// light.
const VEIL: f64 = 25.0;

impl Murk {
    /// The water of a world; `None` without any.
    pub(super) fn of(world: &World) -> Option<Self> {
        world.water_level.map(|level| Self::new(level, world.water.turbidity))
    }

    fn new(level: f64, scattered: f64) -> Self {
        let down = Fading::new(PURE.map(|absorbed| absorbed + (1.0 - FORWARD) * scattered));
        let along = Fading::new(PURE.map(|absorbed| absorbed + scattered));
        Self { level, absorbed: PURE, scattered, down, along }
    }

    /// Changes a finished picture of a camera.
    pub(super) fn veil(&self, canvas: &mut Canvas, view: &View) {
        let (rays, width, eye) = (Rays::of(view), canvas.width, view.eye[2]);
        let veil = self.endless((self.level - eye).max(0.0));
        let rows = canvas.colours.chunks_exact_mut(width).zip(canvas.nearness.chunks_exact(width));
        for (row, (colours, nearness)) in rows.enumerate() {
            for (column, (colour, &near)) in colours.iter_mut().zip(nearness).enumerate() {
                let ray = rays.direction(column, row);
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
                    let length = (ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]).sqrt();
                    let below = if depth.is_finite() { self.level - eye - ray[2] * depth } else { 0.0 };
                    *colour = self.seen(*colour, wet * length, below.max(0.0), veil);
                }
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
        let left = self.down.left(depth);
        [0, 1, 2].map(|i| VEIL * self.scattered / (self.absorbed[i] + self.scattered) * left[i])
    }

    /// A colour at a depth seen through so many metres of water, which veils it.
    #[inline]
    fn seen(&self, colour: Packed, way: f64, depth: f64, veil: [f64; 3]) -> Packed {
        let (there, through) = (self.down.left(depth), self.along.left(way));
        let level = |i: usize, shift: u32| {
            let level =
                f64::from(colour >> shift & 255) * there[i] * through[i] + veil[i] * (1.0 - through[i]);
            ((level.min(255.0) + 0.5) as Packed) << shift
        };
        level(0, 16) | level(1, 8) | level(2, 0)
    }
}

impl Fading {
    fn new(rates: [f64; 3]) -> Self {
        let per_metre = STEPS * rates.into_iter().fold(0.0, f64::max);
        let mut fading = Self { rates, table: Vec::new(), per_metre };
        fading.table = (0..ENTRIES).map(|entry| fading.exactly(f64::from(entry) / per_metre)).collect();
        fading
    }

    fn exactly(&self, metres: f64) -> [f64; 3] {
        self.rates.map(|rate| math::exp(-rate * metres))
    }

    /// What is left after some metres, at least 0.
    #[inline]
    fn left(&self, metres: f64) -> [f64; 3] {
        let steps = metres * self.per_metre;
        let entry = steps as usize;
        let Some([here, next]) =
            self.table.get(entry..entry.saturating_add(2)).map(|pair| [pair[0], pair[1]])
        else {
            return self.exactly(metres);
        };
        let share = steps - entry as f64;
        [0, 1, 2].map(|i| here[i] + (next[i] - here[i]) * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn murk(turbidity: f64) -> Murk {
        Murk::new(2.0, turbidity)
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
    fn light_fades_exponentially_from_next_to_the_camera_to_beyond_sight() {
        let fading = Fading::new([1.3, 0.5, 0.01]);
        for metres in [0.0, 0.0011, 0.8, 3.3333, 24.59, 24.7, 1e3, f64::INFINITY] {
            let (exact, left) = (fading.exactly(metres), fading.left(metres));
            assert!((0..3).all(|i| (exact[i] - left[i]).abs() < 1e-4), "{metres}: {exact:?} {left:?}");
        }
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
