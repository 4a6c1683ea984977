use crate::geometry::{Point, Vector, Vector3, direction, math};
use crate::kinematics::marine;
use crate::kinematics::marine::GRAVITY;
use crate::random::Stream;
use crate::world::{Water, Waves, World};

/// The water of a world, as it moves.
#[derive(Debug)]
pub(in crate::io::sim) struct Waters {
    level: f64,
    water: Water,
    waves: Vec<Wave>,
}

/// A regular wave.
#[derive(Debug, Clone, Copy)]
struct Wave {
    amplitude: f64,
    /// Radians per second, and per metre along its way.
    frequency: f64,
    number: f64,
    direction: Vector,
    phase: f64,
}

/// Number of regular waves that make up irregular ones.
const PARTS: u32 = 24;
/// Range of their frequencies, relative to the frequency of the most energy.
const BAND: [f64; 2] = [0.5, 2.5];
/// Height of JONSWAP's peak, relative to a fully developed sea.
const PEAK: f64 = 3.3;
/// Widths of that peak below and above it.
const WIDTH: [f64; 2] = [0.07, 0.09];

impl Waters {
    /// The water of a world; there is none without a level.
    pub(in crate::io::sim) fn of(world: &World, seed: u64) -> Self {
        let mut stream = Stream::new(seed).child("waves", 0);
        let waves = world.water.waves.filter(|_| world.water_level.is_some());
        Self {
            level: world.water_level.unwrap_or(f64::NEG_INFINITY),
            waves: waves.map(|waves| spectrum(&waves, &mut stream)).unwrap_or_default(),
            water: world.water.clone(),
        }
    }

    /// The level of the surface at rest; -∞ without water.
    pub(in crate::io::sim) fn level(&self) -> f64 {
        self.level
    }

    /// Kilograms in a cubic metre.
    pub(in crate::io::sim) fn density(&self) -> f64 {
        self.water.density
    }

    /// The level of the surface at a place and a time.
    pub(in crate::io::sim) fn surface(&self, at: Point, time: f64) -> f64 {
        self.around(at, self.level, [Vector::zeros(); 2], time).level
    }

    pub(super) fn wind(&self) -> Vector {
        self.water.wind
    }

    /// The water around a place at a time, in the mean of a hull that reaches so far ahead and behind, and so
    /// far to both sides: waves shorter than that hardly move it.
    pub(super) fn around(&self, at: Point, z: f64, hull: [Vector; 2], time: f64) -> marine::LocalWater {
        let flow = self.water.current_at(self.level - z);
        let mut water = marine::LocalWater {
            density: self.water.density,
            velocity: Vector3::new(flow.x, flow.y, 0.0),
            ..marine::LocalWater::still(self.level)
        };
        for wave in &self.waves {
            wave.add(&mut water, at, z - self.level, hull, time);
        }
        water
    }
}

impl Wave {
    /// Adds its height, slope and flow; `z` is above the surface at rest. Water above it moves as that at
    /// rest does.
    fn add(&self, water: &mut marine::LocalWater, at: Point, z: f64, hull: [Vector; 2], time: f64) {
        let mean: f64 = hull.iter().map(|half| mean_of(self.number * self.direction.dot(half))).product();
        let amplitude = self.amplitude * mean;
        let phase = self.number * self.direction.dot(&at.coords) - self.frequency * time + self.phase;
        let (sin, cos) = math::sin_cos(phase);
        water.level += amplitude * cos;
        water.slope -= self.direction * (amplitude * self.number * sin);
        let speed = amplitude * self.frequency * math::exp(self.number * z.min(0.0));
        let ahead = self.direction * (speed * cos);
        water.velocity += Vector3::new(ahead.x, ahead.y, speed * sin);
    }
}

/// The mean of a wave over a range about its crest that reaches to a phase: less than its height.
fn mean_of(phase: f64) -> f64 {
    if phase.abs() < 1e-6 { 1.0 } else { math::sin(phase) / phase }
}

fn spectrum(waves: &Waves, stream: &mut Stream) -> Vec<Wave> {
    let peak = std::f64::consts::TAU / waves.period;
    let wave = |frequency: f64, amplitude: f64, phase: f64| Wave {
        amplitude,
        frequency,
        number: frequency * frequency / GRAVITY,
        direction: direction(waves.direction),
        phase,
    };
    if !waves.irregular {
        return vec![wave(peak, 0.5 * waves.height, 0.0)];
    }
    let step = (BAND[1] - BAND[0]) / f64::from(PARTS);
    let parts: Vec<(f64, f64)> = (0..PARTS)
        .map(|part| {
            let ratio = BAND[0] + step * (f64::from(part) + 0.5);
            (ratio, jonswap(ratio))
        })
        .collect();
    // The significant height is four times the standard deviation.
    let energy: f64 = parts.iter().map(|part| part.1).sum();
    let scale = waves.height * waves.height / (8.0 * energy);
    let phase = |stream: &mut Stream| stream.between(0.0, std::f64::consts::TAU);
    parts
        .into_iter()
        .map(|(ratio, density)| wave(ratio * peak, (scale * density).sqrt(), phase(stream)))
        .collect()
}

/// JONSWAP's spectrum, up to a factor, at a frequency in terms of the peak's.
fn jonswap(ratio: f64) -> f64 {
    let width = if ratio <= 1.0 { WIDTH[0] } else { WIDTH[1] };
    let off = (ratio - 1.0) / width;
    let square = ratio * ratio;
    let shape = math::exp(-1.25 / (square * square)) / (square * square * ratio);
    shape * math::pow(PEAK, math::exp(-0.5 * off * off))
}
