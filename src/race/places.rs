use super::corridor::Corridor;
use super::referee::{RaceScore, Referee};
use crate::ParameterError;
use crate::geometry::{Point, Pose};
use crate::parameter::require;

/// An overtaking in a race.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overtaking {
    /// Time at which the car was ahead by its length (s).
    pub time: f64,
    /// Index of the car, and of the one that it has overtaken.
    pub cars: [usize; 2],
}

/// Referee of a race for places: one [`Referee`] for all cars.
///
/// Places are given by the distance along the centre line, from the line on. The race ends when the first car
/// has completed its laps. A car has overtaken another one when it was behind it by a car length, and is
/// ahead of it by a car length. O(cars²) per call.
///
/// ```
/// use roverlab::geometry::{Point, Pose, direction};
/// use roverlab::race::{Corridor, PlaceReferee};
/// let place = |degrees: f64| Point::origin() + direction(degrees.to_radians()) * 20.0;
/// let ring = Corridor::closed(&(0..90).map(|k| (place(4.0 * f64::from(k)), 3.0, 3.0)).collect::<Vec<_>>())?;
/// let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
/// let mut referee = PlaceReferee::new(&ring, wheels, 2, 1, 2.6)?;
/// // The second car starts behind, and is twice as fast.
/// for step in 0..400 {
///     let cars = [f64::from(step), 2.0 * f64::from(step) - 60.0].map(|degrees| {
///         let at = place(degrees);
///         Pose::new(at.x, at.y, degrees.to_radians() + 0.5 * std::f64::consts::PI)
///     });
///     referee.see(0.1 * f64::from(step), &cars, &[0, 0]);
/// }
/// assert!(referee.is_over() && referee.places() == [2, 1]);
/// assert_eq!(referee.overtakings()[0].cars, [1, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PlaceReferee {
    referees: Vec<Referee>,
    /// Distance of the race, and length of a car (m).
    distance: f64,
    car_length: f64,
    /// For each pair of cars, the one that was ahead last.
    order: Vec<([usize; 2], Option<usize>)>,
    overtakings: Vec<Overtaking>,
}

impl PlaceReferee {
    /// A referee for a number of cars on a closed track whose line is at the first station.
    ///
    /// # Errors
    ///
    /// If there is no car or no lap, or the length of a car is not positive.
    pub fn new(
        corridor: &Corridor,
        wheels: [Point; 4],
        cars: usize,
        laps: usize,
        car_length: f64,
    ) -> Result<Self, ParameterError> {
        require("cars", cars as f64, (1..=1000).contains(&cars), "1 to 1000")?;
        require("laps", laps as f64, laps > 0, "1 or more")?;
        crate::parameter::require_positive("length of a car", car_length)?;
        let pairs = (0..cars).flat_map(|a| (a + 1..cars).map(move |b| ([a, b], None)));
        Ok(Self {
            referees: vec![Referee::new(corridor.clone(), wheels); cars],
            distance: corridor.length() * laps as f64,
            car_length,
            order: pairs.collect(),
            overtakings: Vec::new(),
        })
    }

    /// Takes the poses of all cars at a time, and the number of cones that each has knocked over so far.
    /// Further cars are ignored.
    pub fn see(&mut self, time: f64, poses: &[Pose], cones_hit: &[usize]) {
        for ((referee, pose), hits) in self.referees.iter_mut().zip(poses).zip(cones_hit) {
            referee.see(time, *pose, *hits);
        }
        for (pair, ahead) in &mut self.order {
            let [a, b] = pair.map(|car| self.referees[car].distance());
            if (a - b).abs() < self.car_length {
                continue;
            }
            let [leader, follower] = if a > b { *pair } else { [pair[1], pair[0]] };
            if ahead.replace(leader) == Some(follower) {
                self.overtakings.push(Overtaking { time, cars: [leader, follower] });
            }
        }
    }

    /// Whether a car has completed its laps.
    pub fn is_over(&self) -> bool {
        self.referees.iter().any(|referee| referee.distance() >= self.distance)
    }

    /// Place of each car, from 1 on. Of cars at equal distances, the first one is ahead.
    pub fn places(&self) -> Vec<usize> {
        let way = |car: usize| self.referees[car].distance();
        let cars = 0..self.referees.len();
        let is_ahead =
            |other: usize, car: usize| way(other) > way(car) || (way(other) == way(car) && other < car);
        cars.clone().map(|car| 1 + cars.clone().filter(|other| is_ahead(*other, car)).count()).collect()
    }

    /// Laps and penalties of a car, if there is such a car.
    pub fn score(&self, car: usize) -> Option<&RaceScore> {
        self.referees.get(car).map(Referee::verdict)
    }

    /// Distance of a car from the line, over all laps (m), if there is such a car.
    pub fn distance(&self, car: usize) -> Option<f64> {
        self.referees.get(car).map(Referee::distance)
    }

    /// All overtakings so far.
    pub fn overtakings(&self) -> &[Overtaking] {
        &self.overtakings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;

    fn referee(cars: usize) -> PlaceReferee {
        let place = |degrees: u32| Point::origin() + direction(f64::from(degrees).to_radians()) * 20.0;
        let ring: Vec<_> = (0..120).map(|k| (place(3 * k), 3.0, 3.0)).collect();
        let wheels = [(0.0, 0.6), (0.0, -0.6), (1.5, 0.6), (1.5, -0.6)].map(|(x, y)| Point::new(x, y));
        PlaceReferee::new(&Corridor::closed(&ring).unwrap(), wheels, cars, 2, 2.6).unwrap()
    }

    fn at(angle: f64) -> Pose {
        let place = direction(angle) * 20.0;
        Pose::new(place.x, place.y, angle + std::f64::consts::FRAC_PI_2)
    }

    #[test]
    fn places_change_only_by_a_car_length() {
        let mut referee = referee(2);
        // The second car comes up to half a car length and falls back again, then it passes.
        for (step, lead) in [-5.0, -3.0, 1.3, -3.0, -5.0, -1.0, 1.0, 3.0, 5.0].into_iter().enumerate() {
            let first = 0.1 * step as f64;
            referee.see(step as f64, &[at(first), at(first + lead / 20.0)], &[0, 1]);
        }
        let found = referee.overtakings();
        assert!(found.len() == 1 && found[0].cars == [1, 0] && found[0].time == 7.0, "{found:?}");
        assert_eq!(referee.places(), [2, 1]);
        assert_eq!(referee.score(1).unwrap().cones_hit, 1);
        assert!(!referee.is_over() && referee.score(2).is_none() && referee.distance(2).is_none());
    }

    #[test]
    fn a_car_behind_the_line_has_not_yet_begun() {
        let mut referee = referee(2);
        referee.see(0.0, &[at(-0.3), at(-0.6)], &[0, 0]);
        let [first, second] = [0, 1].map(|car| referee.distance(car).unwrap());
        assert!(first < 0.0 && second < first, "{first} {second}");
        assert!((first - second - 6.0).abs() < 1.2, "{first} {second}");
    }

    #[test]
    fn nonsense_is_refused() {
        let ring: Vec<_> =
            (0..120).map(|k| (Point::origin() + direction(0.05 * f64::from(k)) * 20.0, 3.0, 3.0)).collect();
        let ring = Corridor::closed(&ring).unwrap();
        let wheels = [Point::origin(); 4];
        for (cars, laps, length) in [(0, 1, 2.6), (2, 0, 2.6), (2, 1, 0.0), (2, 1, f64::NAN)] {
            assert!(PlaceReferee::new(&ring, wheels, cars, laps, length).is_err());
        }
    }
}
