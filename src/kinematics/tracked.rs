use super::Differential;
use crate::ParameterError;
use crate::geometry::{Vector, math};
use crate::parameter::require_positive;

/// Geometry of a drive with two belts side by side, which turns by skidding (book, section 7.3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracked {
    /// Distance between the centre lines of the belts (m).
    pub track: f64,
    /// Length of the belts' contact areas (m).
    pub length: f64,
    /// Width of a belt (m).
    pub width: f64,
}

/// Sample points of the contact area, as fractions of the belt's length from its centre.
const ALONG: [f64; 4] = [-0.5, -1.0 / 6.0, 1.0 / 6.0, 0.5];
/// The same across the belt, as fractions of its width.
const ACROSS: [f64; 2] = [-0.5, 0.5];

impl Tracked {
    /// A drive with belts of a given size.
    ///
    /// # Errors
    ///
    /// If a length is not positive and finite, or the belts are wider than the track.
    pub fn new(track: f64, length: f64, width: f64) -> Result<Self, ParameterError> {
        require_positive("track", track)?;
        require_positive("belt length", length)?;
        require_positive("belt width", width)?;
        let apart = "at most the distance between the belts";
        crate::parameter::require("belt width", width, width <= track, apart)?;
        Ok(Self { track, length, width })
    }

    /// Contact points of a belt, relative to the centre of the robot (m); on level ground all carry the same
    /// load. `side` is 1 for the left belt, -1 for the right one.
    pub fn places(&self, side: f64) -> impl Iterator<Item = Vector> {
        let Self { track, length, width } = *self;
        ALONG.into_iter().flat_map(move |along| {
            let across = move |across: f64| Vector::new(along * length, side * 0.5 * track + across * width);
            ACROSS.into_iter().map(across)
        })
    }

    /// The differential drive that moves like this one on level ground.
    ///
    /// Belts slide sideways in turns, so the robot turns less than their speeds and distance suggest: the
    /// instantaneous centres of rotation lie outside the belts (Martínez et al., *Approximating Kinematics
    /// for Tracked Mobile Robots*, 2005). For a turn on the spot under Coulomb friction and even load, they
    /// lie where the power is minimal; that distance is the track of the equivalent drive.
    ///
    /// ```
    /// use roverlab::kinematics::Tracked;
    /// let drive = Tracked::new(0.2, 0.3, 0.05)?;
    /// assert!(drive.equivalent().track > 1.3 * drive.track);
    /// # Ok::<(), roverlab::ParameterError>(())
    /// ```
    pub fn equivalent(&self) -> Differential {
        // By symmetry the left belt suffices. It moves backwards at 1 m/s while the robot turns
        // counter-clockwise. The power is convex in the angular velocity and minimal where its slope is 0.
        let slope = |rate: f64| -> f64 {
            let pull = |place: Vector| {
                let (ahead, aside) = (1.0 - rate * place.y, rate * place.x);
                (rate * place.x * place.x - ahead * place.y) / math::hypot(ahead, aside).max(1e-12)
            };
            self.places(1.0).map(pull).sum()
        };
        let (mut slow, mut fast) = (0.0, 2.0 / (self.track - self.width).max(1e-3 * self.track));
        for _ in 0..60 {
            let middle = 0.5 * (slow + fast);
            if slope(middle) < 0.0 { slow = middle } else { fast = middle }
        }
        Differential { track: 4.0 / (slow + fast) }
    }

    /// Downhill drift of a turn on the spot per radian, for a slope and a friction coefficient of 1 (m/rad).
    /// It is proportional to the slope, and inversely proportional to the friction coefficient.
    ///
    /// In a turn, the whole of each belt slides, with a friction that does not depend on the speed. Against a
    /// small force across its slide, a point of the belt yields like a viscous one whose coefficient is the
    /// friction divided by the speed of the slide.
    ///
    /// ```
    /// use roverlab::kinematics::Tracked;
    /// let drive = Tracked::new(0.185, 0.26, 0.07)?;
    /// // On 3 degrees, with a friction of 0.8, a turn by 3 radians.
    /// let slid = drive.downhill_drift() * 3.0 * 0.0524 / 0.8;
    /// assert!((slid - 0.048).abs() < 0.01);
    /// # Ok::<(), roverlab::ParameterError>(())
    /// ```
    pub fn downhill_drift(&self) -> f64 {
        let half = 0.5 * self.equivalent().track;
        let slides = self.places(1.0).map(|place| math::hypot(half - place.y, place.x));
        let (sum, count) =
            slides.fold((0.0, 0.0), |(sum, count), slide| (sum + 1.0 / slide.max(1e-6), count + 1.0));
        // A pull along the slide meets no more than friction anyway: of the two directions one yields.
        2.0 * count / sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn the_centres_lie_outside_the_belts_and_the_farther_the_longer_they_are(
            track in 0.05..1.0f64, length in 0.05..1.0f64, width in 0.01..0.5f64,
        ) {
            prop_assume!(width < 0.5 * track && length > 2.0 * width);
            let belts = |length| Tracked::new(track, length, width).unwrap().equivalent().track;
            let (short, long) = (belts(length), belts(1.1 * length));
            prop_assert!(short > track, "{} {}", short, track);
            prop_assert!(long >= short - 1e-9, "{} {}", long, short);
            let scaled = Tracked::new(2.0 * track, 2.0 * length, 2.0 * width).unwrap().equivalent().track;
            prop_assert!((scaled - 2.0 * short).abs() < 1e-6 * scaled);
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for (track, length, width) in
            [(0.0, 1.0, 0.1), (1.0, f64::NAN, 0.1), (1.0, 1.0, -0.1), (0.1, 1.0, 0.2)]
        {
            assert!(Tracked::new(track, length, width).is_err());
        }
    }
}
