//! Keeping the lane by camera: what is seen of it beside what is true, and whole drives.

#[path = "lane_keeping/book_loop.rs"]
mod book_loop;
#[path = "lane_keeping/laps.rs"]
mod laps;
#[path = "lane_keeping/real_road.rs"]
mod real_road;

use std::ops::ControlFlow;

use image::RgbImage;
use roverlab::drive::lane_keeping::{LaneKeeper, LaneKeeperParameters, LaneObservation};
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules, FreeDriveScore};
use roverlab::geometry::{Pose, math, units};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Clock, Resolution};
use roverlab::random::Stream;
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::world::formats::course;
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, Scene};

/// A course with worn paint and patches of light, and a car at its start in a light of 50 to 150 %.
fn simulation(course: &RoadCourse, seed: u64, pixel: f64) -> Simulation {
    let mut random = Stream::new(seed);
    let look = Appearance { pixel, wear: random.between(0.0, 0.35), glare: random.below(6), seed };
    let scene = Scene::with_robot(course.world(&look).unwrap(), RobotSpec::road_car(), course.start());
    let options = SimOptions { light: random.between(0.5, 1.5), ..SimOptions::with_noise(1.0, seed) };
    Simulation::new(&scene, options).unwrap()
}

fn camera() -> RoadCamera {
    RobotSpec::road_car().camera.as_ref().unwrap().into()
}

/// Squared errors of what is seen, and how many are within two deviations.
#[derive(Debug, Default)]
struct Errors {
    frames: usize,
    offset: f64,
    heading: f64,
    within: [usize; 3],
    /// Largest error of the offset 1.2 m ahead (m).
    far: f64,
}

impl Errors {
    fn rms(&self, squares: f64) -> f64 {
        (squares / self.frames as f64).sqrt()
    }

    /// Looks at a generated course.
    fn look(&mut self, seed: u64, pixel: f64, most: usize) {
        self.look_at(&generate(seed, &RoadCourseOptions::default()).unwrap(), seed, pixel, most);
    }

    /// Carries a car along a course, aside of the lane's middle and askew, and compares what it sees in the
    /// next metre.
    fn look_at(&mut self, course: &RoadCourse, seed: u64, pixel: f64, most: usize) {
        let simulation = simulation(course, seed, pixel);
        let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
        car.set_resolution(Resolution::Qvga).unwrap();
        let mut keeper =
            LaneKeeper::new(camera(), RoadModel::default(), LaneKeeperParameters::default()).unwrap();
        let mut image = RgbImage::default();
        let (mut odometry, mut before): (Pose, Option<Pose>) = (Pose::default(), None);
        let count = ((course.line.length() / 0.07) as usize).min(most);
        for frame in 0..count {
            let along = 0.07 * frame as f64;
            let aside = course.pose(along, 0.04 * math::sin(1.3 * along));
            let askew = 0.052 * math::cos(1.3 * along);
            truth.move_robot(0, 0, Pose::new(aside.x, aside.y, aside.heading + askew)).unwrap();
            car.wait(0.04).unwrap();
            car.image_into(&mut image).unwrap();
            let pose = truth.pose(0).unwrap();
            odometry =
                odometry.compose(&before.map_or(Pose::default(), |last| last.inverse().compose(&pose)));
            before = Some(pose);
            let lane = keeper.see(&image, odometry).unwrap();
            if frame < 4 {
                continue;
            }
            self.frames += 1;
            let true_lane = course.locate(&pose, Some(along));
            let off = [
                lane.offset - true_lane.offset,
                lane.heading - true_lane.heading,
                lane.curvature - true_lane.curvature,
            ];
            for (within, (off, sigma)) in self.within.iter_mut().zip(off.into_iter().zip(lane.sigmas)) {
                *within += usize::from(off.abs() < 2.0 * sigma);
            }
            for ahead in [0.2, 0.4, 0.6, 0.8, 1.0] {
                let there = course.locate(&pose.compose(&lane.place(ahead)), Some(along + ahead));
                self.offset += 0.2 * there.offset * there.offset;
                self.heading += 0.2 * there.heading * there.heading;
            }
            let far = course.locate(&pose.compose(&lane.place(1.2)), Some(along + 1.2));
            self.far = self.far.max(far.offset.abs());
        }
    }

    fn check(&self) {
        let (offset, heading) = (self.rms(self.offset), units::to_deg(self.rms(self.heading)));
        let within = self.within.map(|count| count as f64 / self.frames as f64);
        println!("{} frames: {:.1} mm, {heading:.2} degrees, within {within:.3?}", self.frames, 1e3 * offset);
        assert!(offset < 0.008 && heading < 0.6, "{offset} m, {heading} degrees");
        assert!(within.iter().all(|share| (0.93..0.97).contains(share)), "{within:?}");
    }
}

#[test]
fn the_lane_is_where_it_is_seen() {
    let mut errors = Errors::default();
    // Neighbouring frames err alike: of fewer courses, shares vary by several hundredths.
    (1..9).for_each(|seed| errors.look(seed, 0.004, 120));
    errors.check();
}

#[test]
fn strokes_of_numbers_in_a_bend_are_no_lines_of_the_road() {
    for turn in [60, -60] {
        let bend = format!("arc 1430 {turn}\nspeed-end 60\narc 1430 {turn}\nspeed 34\narc 1430 {turn}\n");
        let half = format!("straight 1400\nspeed 50\nstraight 1000\nspeed-end 34\n{bend}");
        let course = course::parse(&format!("course 1\nlane 400\n{half}{half}"), "oval").unwrap();
        for seed in 1..=2 {
            let mut errors = Errors::default();
            errors.look_at(&course, seed, 0.004, 110);
            // The next line is 0.42 m aside.
            assert!(errors.far < 0.1, "{turn} {seed}: {} m at 1.2 m", errors.far);
        }
    }
}

/// Drives for some seconds, or until the car has to be taken over.
fn drive(course: RoadCourse, seed: u64, seconds: f64) -> FreeDriveScore {
    let simulation = simulation(&course, seed, 0.002);
    let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let mut keeper =
        LaneKeeper::new(camera(), RoadModel::default(), LaneKeeperParameters::default()).unwrap();
    let mut referee = FreeDrive::new(course, &RobotSpec::road_car(), FreeDriveRules::default()).unwrap();
    run(&mut car, &mut keeper, seconds, |_, _, _| until(referee.see(truth.time(), &truth.pose(0).unwrap())))
        .unwrap();
    *referee.score()
}

/// The stripes of a crosswalk lie aslant in the view.
#[test]
fn a_crosswalk_may_be_just_behind_a_tight_bend() {
    let bends = "arc 1440 180\nstraight 150\nzebra\nstraight 3850\narc 1440 180\nstraight 3000\n";
    let course = course::parse(&format!("course 1\nlane 400\nstraight 1000\n{bends}"), "oval").unwrap();
    let score = drive(course, 3, 5.0);
    assert_eq!((score.departures, score.interventions), (0, 0), "{score:?}");
    assert!(score.offset_rms() < 0.012, "{score:?}");
}

/// For a metre, the dashes of the centre line alone tell that the bend to the left became one to the right.
#[test]
fn both_edges_may_be_missing_where_bends_meet() {
    let bends = "arc 1377 90\narc 1377 -8\ngap left 1000\ngap right 1000\narc 1377 -82\narc 1377 90\n";
    let side = format!("straight 600\n{bends}");
    for seed in 2..4 {
        let text = format!("course 1\nlane 350\n{side}{side}{side}{side}");
        let score = drive(course::parse(&text, "star").unwrap(), seed, 3.0);
        assert_eq!((score.departures, score.interventions), (0, 0), "{seed}: {score:?}");
        assert!(score.offset_rms() < 0.012, "{seed}: {score:?}");
    }
}

/// The least angle between two passes, right behind bends that are nearly as tight as can be.
#[test]
fn a_road_may_cross_itself_at_70_degrees() {
    let pass = "straight 1571\ncrossing 70 none\nstraight 1571\n";
    let text = format!("course 1\nlane 400\n{pass}arc 1100 250\n{pass}arc 1100 -250\n");
    for seed in 1..4 {
        let score = drive(course::parse(&text, "eight").unwrap(), seed, 15.0);
        assert_eq!((score.departures, score.interventions), (0, 0), "{seed}: {score:?}");
        assert!(score.offset_rms() < 0.015, "{seed}: {score:?}");
    }
}

#[test]
fn a_gap_of_a_metre_and_a_blackout_are_driven_through_by_odometry() {
    let course = generate(2, &RoadCourseOptions::default()).unwrap();
    let simulation = simulation(&course, 2, 0.004);
    let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let mut keeper =
        LaneKeeper::new(camera(), RoadModel::default(), LaneKeeperParameters::default()).unwrap();
    let mut referee = FreeDrive::new(course, &RobotSpec::road_car(), FreeDriveRules::default()).unwrap();
    let dark = |robot: &mut roverlab::io::sim::SimRobot, time: f64, seen: &mut LaneObservation| {
        use roverlab::io::Odometry;
        robot.set_resolution(Resolution::Qvga)?;
        robot.image_into(&mut seen.image)?;
        if (2.0..2.3).contains(&time) {
            seen.image.fill(30);
        }
        (seen.odometry, seen.speed) = (robot.pose()?, robot.speed()?.linear);
        Ok(())
    };
    let mut behaviour = roverlab::io::control::SensedBy::new(&mut keeper, dark);
    run(&mut car, &mut behaviour, 5.0, |_, _, _| {
        referee.see(truth.time(), &truth.pose(0).unwrap());
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(referee.score().departures, 0, "{:?}", referee.score());
    assert!(referee.score().distance > 5.0);
}

/// What takes minutes.
mod campaigns {
    use super::*;

    #[test]
    #[ignore = "a campaign: cargo test --release --all-features --test lane_keeping campaigns -- --ignored --nocapture"]
    fn perception_of_ten_thousand_frames() {
        let mut errors = Errors::default();
        (1..40).for_each(|seed| errors.look(seed, 0.002, usize::MAX));
        assert!(errors.frames >= 10_000);
        errors.check();
    }

    #[test]
    #[ignore = "a campaign: cargo test --release --all-features --test lane_keeping campaigns -- --ignored --nocapture"]
    fn free_drive_on_twenty_courses() {
        for seed in 1..=20 {
            let course = generate(seed, &RoadCourseOptions::default()).unwrap();
            let score = drive(course, seed, 120.0);
            println!("{seed}: {:.1} m, {:.1} mm", score.distance, 1e3 * score.offset_rms());
            assert_eq!((score.departures, score.interventions), (0, 0), "{seed}: {score:?}");
            assert!(score.distance > 230.0 && score.offset_rms() < 0.025, "{seed}: {score:?}");
        }
    }
}
