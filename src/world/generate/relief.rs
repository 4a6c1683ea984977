use crate::ParameterError;
use crate::geometry::{Aabb, Point, Pose, Vector, direction, math, normalize_angle};
use crate::parameter::{require, require_up_to};
use crate::random::Stream;
use crate::world::{HeightField, Terrain, World};

/// Kind of hills that [`relief`] generates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ReliefKind {
    /// Hills and mesas, some of them too steep; one is the highest.
    Range,
    /// A ring around a hollow filled with water (book, section 7.3).
    Crater,
    /// A ramp up, a bank and a ramp down beside or opposite to it, inside a high rim (book, section 7.3).
    Ramp,
    /// Terraces with steep faces, each with a ramp up to it.
    Steps,
}

impl ReliefKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Range, Self::Crater, Self::Ramp, Self::Steps];
}

/// Options of [`relief`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefOptions {
    /// Kind of hills.
    pub kind: ReliefKind,
    /// Side length of the square (m).
    pub side: f64,
    /// Elevation of the highest place (m).
    pub top: f64,
    /// Slope of ramps, and approximately of the sides of hills (rad).
    pub slope: f64,
    /// Number of samples along a side.
    pub samples: usize,
}

impl ReliefOptions {
    /// The book's sizes: ranges and craters of 5 m by 5 m and up to 0.5 m high, ramps and steps of 4 m by 4 m
    /// up to 0.2 m.
    pub fn of(kind: ReliefKind) -> Self {
        let (side, top) = match kind {
            ReliefKind::Range | ReliefKind::Crater => (5.0, 0.5),
            ReliefKind::Ramp | ReliefKind::Steps => (4.0, 0.2),
        };
        Self { kind, side, top, slope: 0.27, samples: 257 }
    }

    /// Fails for an option out of range; the error names it.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require("side", self.side, (1.0..=1e4).contains(&self.side), "1 to 10000 m")?;
        require_up_to("top", self.top, 0.25 * self.side)?;
        require("slope", self.slope, (0.05..=1.0).contains(&self.slope), "0.05 to 1 rad")?;
        let fits = self.top / math::tan(self.slope) <= ROOM * self.side;
        require(
            "slope",
            self.slope,
            fits,
            "steep enough that a ramp to the top is shorter than 0.47 of the side",
        )?;
        let count = (33..=HeightField::MAX_SAMPLES).contains(&self.samples);
        require("samples", self.samples as f64, count, "33 to 4097")
    }
}

/// Generated hills.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// The hills, without walls; craters with their water.
    pub world: World,
    /// Start pose on gentle ground near the border; before a ramp, facing up.
    pub start: Pose,
    /// Centre line over ramps: foot, middle of the bank at each ramp, foot. Empty for other kinds.
    pub way: Vec<Point>,
}

/// Generates hills. The same stream gives the same hills on every platform.
///
/// `nav::elevation::ElevationMap` determines what a robot can reach on them, and how high that is.
///
/// ```
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
/// let range = relief(&mut Stream::new(1), &ReliefOptions::of(ReliefKind::Range))?;
/// let ground = range.world.terrain.and_then(|terrain| terrain.surface).unwrap();
/// assert!((ground.highest() - 0.5).abs() < 1e-6 && ground.lowest() >= 0.0);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn relief(stream: &mut Stream, options: &ReliefOptions) -> Result<Relief, ParameterError> {
    options.validate()?;
    match options.kind {
        ReliefKind::Range => range(stream, options),
        ReliefKind::Crater => crater(stream, options),
        ReliefKind::Ramp => ramp(stream, options),
        ReliefKind::Steps => steps(stream, options),
    }
}

fn world(options: &ReliefOptions, height: impl FnMut(Point) -> f64) -> Result<World, ParameterError> {
    let side = options.side;
    let area = Aabb::new(Point::origin(), Point::new(side, side));
    let surface = HeightField::from_fn(options.samples, options.samples, area, height)?;
    let kind = format!("{:?}.png", options.kind).to_lowercase();
    Ok(World { terrain: Some(Terrain::new(kind, surface)), ..World::empty(side, side) })
}

/// A hill, or a mesa with a level top.
struct Hill {
    middle: Point,
    height: f64,
    /// Along and across (m).
    size: Vector,
    along: Vector,
    mesa: bool,
}

impl Hill {
    fn draw(stream: &mut Stream, options: &ReliefOptions, mesa: bool) -> Self {
        let ReliefOptions { side, top, slope, .. } = *options;
        let middle = Point::new(stream.between(0.2, 0.8) * side, stream.between(0.2, 0.8) * side);
        let height = stream.between(0.35, 1.0) * top;
        // The side of a bell is 0.61 times its height over its width at the steepest.
        let steepness = math::tan(slope) * if mesa { 3.0 } else { stream.between(0.5, 1.4) };
        let width = 0.61 * height / steepness;
        let size = Vector::new(width * stream.between(1.0, 1.8), width);
        let along = direction(stream.between(0.0, std::f64::consts::PI));
        let size = if mesa { size + Vector::new(0.08, 0.08) * side } else { size };
        Self { middle, height, size, along, mesa }
    }

    fn at(&self, point: Point) -> f64 {
        let away = point - self.middle;
        let across = Vector::new(-self.along.y, self.along.x);
        let scaled = Vector::new(away.dot(&self.along) / self.size.x, away.dot(&across) / self.size.y);
        let square = scaled.norm_squared();
        let bell = if self.mesa { 0.5 * square * square * square } else { 0.5 * square };
        self.height * math::exp(-bell)
    }
}

fn range(stream: &mut Stream, options: &ReliefOptions) -> Result<Relief, ParameterError> {
    let hills = 4 + stream.below(5);
    let mesas = stream.below(3);
    let hills: Vec<Hill> = (0..hills + mesas).map(|i| Hill::draw(stream, options, i >= hills)).collect();
    let height = |point: Point| hills.iter().map(|hill| hill.at(point)).sum::<f64>();
    let rough = world(options, height)?;
    let ground = ground_of(&rough);
    let (low, high) = (ground.lowest(), ground.highest());
    let world = world(options, |point| options.top * (height(point) - low) / (high - low))?;
    let start = low_start(stream, options, ground_of(&world));
    Ok(Relief { world, start, way: Vec::new() })
}

fn ground_of(world: &World) -> &HeightField {
    let surface = world.terrain.as_ref().and_then(|terrain| terrain.surface.as_deref());
    surface.expect("a world that was made with a surface")
}

/// Number of places drawn for a start.
const DRAWN: usize = 200;
/// Distance of a start from the border (fraction of the side).
const INSIDE: f64 = 0.12;

/// The lowest of several places near the border with gentle surroundings, with a random heading.
fn low_start(stream: &mut Stream, options: &ReliefOptions, ground: &HeightField) -> Pose {
    let side = options.side;
    let inside = |share: f64| (INSIDE + (1.0 - 2.0 * INSIDE) * share) * side;
    let mut best = (f64::INFINITY, Point::new(inside(0.0), inside(0.0)));
    for _ in 0..DRAWN {
        let (along, aside) = (inside(stream.uniform()), inside(stream.below(2) as f64));
        let place = if stream.chance(0.5) { Point::new(along, aside) } else { Point::new(aside, along) };
        let steepness = steepest_around(ground, place, 0.05 * side);
        if steepness < best.0 {
            best = (steepness, place);
        }
        if steepness < 0.3 * math::tan(options.slope) {
            break;
        }
    }
    let heading = normalize_angle(stream.between(0.0, std::f64::consts::TAU));
    Pose::new(best.1.x, best.1.y, heading)
}

fn steepest_around(ground: &HeightField, place: Point, radius: f64) -> f64 {
    let ring = (0..8).map(|i| direction(std::f64::consts::FRAC_PI_4 * f64::from(i)) * radius);
    let places = ring.chain([Vector::zeros()]).map(|away| place + away);
    places.map(|at| ground.gradient(at).map_or(f64::INFINITY, |rise| rise.norm())).fold(0.0, f64::max)
}

fn crater(stream: &mut Stream, options: &ReliefOptions) -> Result<Relief, ParameterError> {
    let ReliefOptions { side, top, slope, .. } = *options;
    let middle = Point::new(stream.between(0.42, 0.58) * side, stream.between(0.42, 0.58) * side);
    let radius = stream.between(0.22, 0.26) * side;
    // One side of the rim is higher than the other, and the outer flank gentler than the inner one.
    let high = stream.between(0.0, std::f64::consts::TAU);
    let outer = 0.61 * top / math::tan(slope);
    let inner = 0.45 * radius;
    let floor = stream.between(0.1, 0.25);
    let height = |point: Point| {
        let away = point - middle;
        let distance = away.norm();
        let towards = if distance > 0.0 { away.dot(&direction(high)) / distance } else { 0.0 };
        let rim = 0.5 * (distance - radius) / if distance > radius { outer } else { inner };
        let base = if distance > radius { 0.0 } else { floor };
        let share = base + (0.85 + 0.15 * towards - base) * math::exp(-2.0 * rim * rim);
        top * share
    };
    let rough = world(options, height)?;
    let highest = ground_of(&rough).highest();
    let mut world = world(options, |point| height(point) * top / highest)?;
    world.water_level = Some(0.5 * (floor + 0.5) * top);
    let start = low_start(stream, options, ground_of(&world));
    Ok(Relief { world, start, way: Vec::new() })
}

/// Maximum length of the ramp to the top (fraction of the side), which leaves room before its foot and behind
/// the bank.
const ROOM: f64 = 0.47;
/// Width of the rim around ramps and steps (fraction of the side).
const RIM: f64 = 0.03;

fn is_rim(point: Point, side: f64) -> bool {
    let inside = RIM * side..=(1.0 - RIM) * side;
    !(inside.contains(&point.x) && inside.contains(&point.y))
}

fn ramp(stream: &mut Stream, options: &ReliefOptions) -> Result<Relief, ParameterError> {
    let ReliefOptions { side, top, slope, .. } = *options;
    let (length, width) = (top / math::tan(slope), stream.between(0.13, 0.17) * side);
    // The second ramp leads back or on, beside the first one, or straight on.
    let through = 2.0 * length + width <= (ROOM + 0.17) * side;
    let back = stream.chance(0.5) || !through;
    let aside = [1.0, -1.0, 0.0][stream.below(if back { 2 } else { 3 })];
    let apart = stream.between(1.5, 2.0) * width * aside;
    let heading = std::f64::consts::FRAC_PI_2 * stream.below(4) as f64;
    let depth = if back { length + width } else { 2.0 * length + width };
    let middle = Point::new(0.5 * side, 0.5 * side);
    let foot = middle + rotated(Vector::new(-0.5 * depth, -0.5 * apart), heading);
    let frame = Pose::new(foot.x, foot.y, heading);
    let local = |point: Point| frame.to_local(point);
    let height = |point: Point| {
        if is_rim(point, side) {
            return top;
        }
        let at = local(point);
        let on_first = at.y.abs() <= 0.5 * width;
        let on_second = (at.y - apart).abs() <= 0.5 * width;
        let (least, most) =
            (0.5 * (apart - apart.abs()) - 0.5 * width, 0.5 * (apart + apart.abs()) + 0.5 * width);
        if (length..=length + width).contains(&at.x) && (least..=most).contains(&at.y) {
            top
        } else if (0.0..length).contains(&at.x) && (on_first || (back && on_second)) {
            top * at.x / length
        } else if (length + width..=depth).contains(&at.x) && !back && on_second {
            top * (depth - at.x) / length
        } else {
            0.0
        }
    };
    let way = [
        Point::origin(),
        Point::new(length + 0.5 * width, 0.0),
        Point::new(length + 0.5 * width, apart),
        Point::new(if back { 0.0 } else { depth }, apart),
    ];
    let start = frame.compose(&Pose::new(
        -0.1 * side,
        stream.between(-0.1, 0.1) * width,
        stream.between(-0.08, 0.08),
    ));
    let way = way.map(|point| frame.to_world(point)).to_vec();
    Ok(Relief { world: world(options, height)?, start, way })
}

fn rotated(vector: Vector, heading: f64) -> Vector {
    let forward = direction(heading);
    Vector::new(forward.x * vector.x - forward.y * vector.y, forward.y * vector.x + forward.x * vector.y)
}

fn steps(stream: &mut Stream, options: &ReliefOptions) -> Result<Relief, ParameterError> {
    let ReliefOptions { side, top, slope, .. } = *options;
    let terraces = 2 + stream.below(2);
    let rise = top / terraces as f64;
    let length = rise / math::tan(slope);
    let first = stream.between(0.35, 0.40) * side;
    let tread = (0.92 * side - first) / terraces as f64;
    let width = 0.15 * side;
    let places: Vec<f64> = (0..terraces).map(|_| stream.between(0.2, 0.8) * side).collect();
    let height = |point: Point| {
        if is_rim(point, side) {
            return 0.0;
        }
        let faces = (0..terraces).map(|number| {
            let beyond = point.x - (first + tread * number as f64);
            let on_ramp = (point.y - places[number]).abs() <= 0.5 * width;
            let share = if on_ramp { 1.0 + beyond / length } else { f64::from(u8::from(beyond >= 0.0)) };
            rise * share.clamp(0.0, 1.0)
        });
        faces.sum()
    };
    let world = world(options, height)?;
    let start = Pose::new(0.08 * side, places[0], stream.between(-0.3, 0.3));
    Ok(Relief { world, start, way: Vec::new() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        #[test]
        fn hills_are_as_high_as_they_should_be_and_start_gently(seed in any::<u64>(), kind in 0..4_usize) {
            let options = ReliefOptions::of(ReliefKind::ALL[kind]);
            let made = relief(&mut Stream::new(seed), &options).unwrap();
            let ground = ground_of(&made.world);
            prop_assert!((ground.highest() - options.top).abs() < 1e-6 && ground.lowest() > -1e-6);
            let start = made.start.position();
            prop_assert!(made.world.floor.contains(start), "{:?}", start);
            prop_assert!(steepest_around(ground, start, 0.1) < math::tan(options.slope));
            prop_assert_eq!(&relief(&mut Stream::new(seed), &options).unwrap(), &made);
        }

        #[test]
        fn the_way_over_a_ramp_leads_up_across_and_down(seed in any::<u64>(), degrees in 7.0..20.0f64) {
            let options = ReliefOptions {
                slope: crate::geometry::units::from_deg(degrees), ..ReliefOptions::of(ReliefKind::Ramp)
            };
            let made = relief(&mut Stream::new(seed), &options).unwrap();
            let ground = ground_of(&made.world);
            let [foot, up, across, down] = made.way[..] else { panic!("{:?}", made.way) };
            let height = |point: Point| ground.height(point).unwrap();
            prop_assert!(height(foot) < 0.02 && height(down) < 0.02);
            prop_assert!((height(up) - options.top).abs() < 1e-6 && (height(across) - options.top).abs() < 1e-6);
            for pair in made.way.windows(2) {
                for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
                    let at = pair[0] + (pair[1] - pair[0]) * share;
                    let rise = ground.gradient(at).unwrap().norm();
                    prop_assert!(rise < 1.05 * math::tan(options.slope), "{} at {}", rise, at);
                }
            }
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let good = ReliefOptions::of(ReliefKind::Range);
        for bad in [
            ReliefOptions { side: f64::NAN, ..good },
            ReliefOptions { top: 0.0, ..good },
            ReliefOptions { top: 2.0, ..good },
            ReliefOptions { slope: 0.0, ..good },
            ReliefOptions { slope: 0.06, top: 1.0, ..good },
            ReliefOptions { samples: 5, ..good },
        ] {
            assert!(relief(&mut Stream::new(1), &bad).is_err(), "{bad:?}");
        }
    }
}
