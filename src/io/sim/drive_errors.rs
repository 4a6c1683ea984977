use super::NoiseModel;
use super::drive_mechanics::AHEAD;
use crate::kinematics::{Differential, Displacement};
use crate::random::Stream;

/// Number of wheels of the drives with the most.
const MOST_WHEELS: usize = 4;

/// One robot's deviations from its description, and its random stream for slip.
#[derive(Debug, Clone)]
pub(super) struct DriveErrors<const N: usize> {
    wheel: [f64; N],
    /// Factor of the true distances between wheels to the described ones.
    size: f64,
    slip: f64,
    command: f64,
    /// Factors of length and angle for the present command.
    command_factors: [f64; 2],
    stream: Stream,
}

impl DriveErrors<2> {
    /// Deviations of a left and a right wheel.
    pub(super) fn of_two_wheels(noise: &NoiseModel, mut stream: Stream) -> Self {
        let scale = noise.wheel_scale * stream.normal();
        let mismatch = 0.5 * noise.wheel_mismatch * stream.normal();
        let wheel = [1.0 + scale - mismatch, 1.0 + scale + mismatch];
        Self::new(wheel, noise, stream)
    }

    /// True motion of a robot whose wheels travelled so far over the ground, in terms of its description.
    pub(super) fn motion(&self, track: f64, [left, right]: [f64; 2]) -> Displacement {
        let motion = Differential { track: track * self.size }.displacement(left, right);
        let [length, angle] = self.command_factors;
        Displacement { length: motion.length * length, angle: motion.angle * angle }
    }
}

impl DriveErrors<4> {
    /// Independent deviations of four wheels.
    pub(super) fn of_four_wheels(noise: &NoiseModel, mut stream: Stream) -> Self {
        let scale = noise.wheel_scale * stream.normal();
        let wheel = [(); 4].map(|()| 1.0 + scale + 0.5 * noise.wheel_mismatch * stream.normal());
        Self::new(wheel, noise, stream)
    }
}

impl<const N: usize> DriveErrors<N> {
    fn new(wheel: [f64; N], noise: &NoiseModel, mut stream: Stream) -> Self {
        let size = positive(1.0 + noise.track * stream.normal());
        Self {
            wheel: wheel.map(positive),
            size,
            slip: noise.slip,
            command: noise.command,
            command_factors: [1.0; 2],
            stream,
        }
    }

    /// Factor of the true distances between wheels to the described ones.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Factors of length and angle for the present command.
    pub(super) fn command_factors(&self) -> [f64; 2] {
        self.command_factors
    }

    /// Draws the errors of a new drive command.
    pub(super) fn begin_command(&mut self) {
        if self.command > 0.0 {
            for factor in &mut self.command_factors {
                *factor = 1.0 + self.command * self.stream.normal();
            }
        }
    }

    /// Replaces the rolls of the wheels, of at most [`AHEAD`] ticks, by their travel over the ground.
    pub(super) fn slip(&mut self, rolls: &mut [[f64; N]]) {
        let mut samples = [0.0; MOST_WHEELS * AHEAD];
        let turning = rolls.as_flattened().iter().filter(|&&rolled| rolled != 0.0).count();
        let drawn = &mut samples[..if self.slip == 0.0 { 0 } else { turning }];
        self.stream.fill_normal(drawn);
        let mut drawn = drawn.iter();
        for rolled in rolls {
            for (travel, scale) in rolled.iter_mut().zip(self.wheel) {
                // A wheel that stands does not slip.
                let sample = if *travel == 0.0 { 0.0 } else { drawn.next().copied().unwrap_or(0.0) };
                *travel *= scale;
                *travel += self.slip * travel.abs().sqrt() * sample;
            }
        }
    }
}

/// Keeps a factor positive that the strongest noise could make negative.
fn positive(factor: f64) -> f64 {
    factor.max(0.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strongest_noise_leaves_wheels_and_a_track() {
        let strongest =
            NoiseModel { wheel_scale: 1.0, wheel_mismatch: 1.0, track: 1.0, ..NoiseModel::ideal() };
        for seed in 0..200 {
            let two = DriveErrors::of_two_wheels(&strongest, Stream::new(seed));
            assert!(two.wheel.iter().all(|&factor| factor >= 0.1) && two.size >= 0.1);
            let four = DriveErrors::of_four_wheels(&strongest, Stream::new(seed));
            assert!(four.wheel.iter().all(|&factor| factor >= 0.1) && four.size >= 0.1);
        }
    }

    #[test]
    fn standing_wheels_draw_no_random_numbers() {
        let mut errors = DriveErrors::of_two_wheels(&NoiseModel::real(), Stream::new(1));
        let mut before = errors.stream.clone();
        let mut rolls = [[0.0; 2]];
        errors.slip(&mut rolls);
        assert_eq!(rolls, [[0.0; 2]]);
        assert_eq!(errors.stream.bits(), before.bits());
    }
}
