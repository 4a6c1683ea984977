//! Driving by the network that comes with the program where it has not learned to: on the book's loop, in
//! other light, on other floors, by other lenses and noise.

#[path = "lane_keeping/book_loop.rs"]
mod book_loop;

use image::RgbaImage;
use roverlab::drive::end_to_end::NetworkDriver;
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules, FreeDriveScore};
use roverlab::geometry::{Pose, units};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive};
use roverlab::random::Stream;
use roverlab::vision::network::{Architecture, Network};
use roverlab::world::road::{
    Alignment, Appearance, Element, RoadCourse, RoadCourseOptions, Traffic, generate,
};
use roverlab::world::{RobotSpec, Scene, Texture, World};

/// The network that comes with the program.
fn network() -> Network {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/cli/nets/steering.safetensors");
    Network::from_safetensors(&std::fs::read(file).unwrap()).unwrap()
}

/// A course, what is on the floor, and the car.
#[derive(Debug, Clone)]
struct Setting {
    course: RoadCourse,
    world: World,
    car: RobotSpec,
    options: SimOptions,
}

impl Setting {
    /// A course that no lesson was on, in the light of a well lit room.
    fn unseen(seed: u64, pixel: f64) -> Self {
        let course = generate(seed, &RoadCourseOptions::default()).unwrap();
        let mut random = Stream::new(seed).child("unseen", 0);
        let wear = random.between(0.0, 0.35);
        let look = Appearance { pixel, wear, glare: random.below(6), seed };
        let world = course.world(&look).unwrap();
        Self { course, world, car: RobotSpec::road_car(), options: SimOptions::with_noise(1.0, seed) }
    }

    /// The floor in other colours, by the shade that it has.
    fn recoloured(mut self, colour: impl Fn(u32, u32, f64) -> [f64; 3]) -> Self {
        let mut image: RgbaImage =
            (**self.world.floor_texture.as_ref().unwrap().image.as_ref().unwrap()).clone();
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let [red, green, blue] = colour(x, y, f64::from(pixel.0[0])).map(|value| value as u8);
            pixel.0 = [red, green, blue, 255];
        }
        self.world.floor_texture = Some(Texture::new("floor.png", image));
        self
    }

    /// Drives for some seconds. A car that strays is stopped and put back into its lane by hand.
    fn drive(&self, network: &Network, seconds: f64) -> FreeDriveScore {
        let scene = Scene::with_robot(self.world.clone(), self.car.clone(), self.course.start());
        let simulation = Simulation::new(&scene, self.options.clone()).unwrap();
        let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
        let mut driver = NetworkDriver::new(network.clone(), 1.0).unwrap();
        let mut referee = FreeDrive::new(self.course.clone(), &self.car, FreeDriveRules::default()).unwrap();
        while truth.time() < seconds {
            run(&mut car, &mut driver, seconds - truth.time(), |_, _, _| {
                until(referee.see(truth.time(), &truth.pose(0).unwrap()))
            })
            .unwrap();
            if referee.is_remote() {
                car.stop().unwrap();
                car.wait(1.0).unwrap();
                truth.set_pose(0, self.course.pose(referee.lane().along, 0.0)).unwrap();
                referee.see(truth.time(), &truth.pose(0).unwrap());
                referee.give_back();
            }
        }
        *referee.score()
    }
}

/// Sums over drives.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    time: f64,
    distance: f64,
    departures: u32,
    interventions: u32,
}

impl Sums {
    fn of(scores: impl IntoIterator<Item = FreeDriveScore>) -> Self {
        scores.into_iter().fold(Self::default(), |sums, score| Self {
            time: sums.time + score.time,
            distance: sums.distance + score.distance,
            departures: sums.departures + score.departures,
            interventions: sums.interventions + score.interventions,
        })
    }

    /// Share of the time driven without interventions (percent).
    fn autonomy(&self) -> f64 {
        100.0 * (1.0 - 6.0 * f64::from(self.interventions) / self.time).max(0.0)
    }

    fn print(&self, name: &str) {
        println!(
            "{name}: autonomy {:.1} %, {:.1} departures per km, {} interventions in {:.0} m",
            self.autonomy(),
            1e3 * f64::from(self.departures) / self.distance.max(1e-9),
            self.interventions,
            self.distance
        );
    }
}

#[test]
fn it_steers_in_light_that_no_lesson_had() {
    let network = network();
    for light in [0.3, 2.0] {
        let setting = Setting::unseen(2, 0.004);
        let options = SimOptions { light, ..setting.options.clone() };
        let score = Setting { options, ..setting }.drive(&network, 4.0);
        assert_eq!((score.departures, score.interventions), (0, 0), "light {light}: {score:?}");
        assert!(score.distance > 3.0, "{score:?}");
    }
}

#[test]
fn a_car_that_strays_is_put_back_and_drives_on() {
    let architecture: Architecture = "8x16x1 dense1".parse().unwrap();
    let straight_on = Network::new(architecture, vec![(vec![0.0; 128], vec![0.0])]).unwrap();
    let score = Setting::unseen(2, 0.004).drive(&straight_on, 12.0);
    assert!((1..8).contains(&score.interventions) && score.distance > 5.0, "{score:?}");
}

/// What takes minutes.
mod campaigns {
    use super::*;

    /// A road for driving on the other side: mirrored in a picture of a width, and so many times as large.
    fn mirrored(course: &RoadCourse, width: f64, times: f64) -> RoadCourse {
        let start = course.line.at(0.0).pose;
        let start = Pose::new(width - start.x, start.y, std::f64::consts::PI - start.heading);
        let elements = course.line.elements().iter().map(|element| {
            let curvature = element.curvature.map(|bend| -bend);
            Element { curvature, ..*element }
        });
        let line = Alignment::new(start, elements.collect());
        RoadCourse { traffic: Traffic::Right, line, ..course.clone() }.scaled(times)
    }

    #[test]
    #[ignore = "a campaign on published data: ROVERLAB_DATA=FOLDER cargo test --release --all-features --test end_to_end campaigns -- --ignored --nocapture"]
    fn the_books_loop_at_the_size_of_lessons() {
        let image = image::imageops::flip_horizontal(&book_loop::picture());
        let network = network();
        let mut all = Vec::new();
        for lane in [0.40, 0.45] {
            let own = book_loop::course();
            let times = lane / own.lane_width;
            let (course, side) = (mirrored(&own, book_loop::SIDE, times), times * book_loop::SIDE);
            let world = World {
                floor_texture: Some(Texture::new("carolo.png", image.clone())),
                ..World::empty(side, side)
            };
            for (light, seed) in [(0.5, 1), (1.0, 2), (1.5, 3)] {
                let options = SimOptions { light, ..SimOptions::with_noise(1.0, seed) };
                let setting = Setting {
                    course: course.clone(),
                    world: world.clone(),
                    car: RobotSpec::road_car(),
                    options,
                };
                let score = setting.drive(&network, 180.0);
                Sums::of([score]).print(&format!("lanes of {lane} m, light {light}"));
                all.push(score);
            }
        }
        let sums = Sums::of(all);
        sums.print("all");
        assert!(sums.autonomy() >= 95.0, "{sums:?}");
    }

    /// A change of what is learned from, by its name.
    type Shift<'s> = (&'s str, Box<dyn Fn(Setting) -> Setting + 's>);

    #[test]
    #[ignore = "a campaign: cargo test --release --all-features --test end_to_end campaigns -- --ignored --nocapture"]
    fn what_it_has_not_learned() {
        let network = network();
        let lens = |setting: Setting, degrees: f64, fisheye: bool, tilt: f64| {
            let mut car = setting.car.clone();
            let camera = car.camera.as_mut().unwrap();
            (camera.field_of_view, camera.fisheye) = (units::from_deg(degrees), fisheye);
            camera.tilt = units::from_deg(tilt);
            Setting { car, ..setting }
        };
        let light = |setting: Setting, light: f64| Setting {
            options: SimOptions { light, ..setting.options.clone() },
            ..setting
        };
        let noise = |setting: Setting, factor: f64| {
            let options = SimOptions::with_noise(factor, setting.options.seed);
            Setting { options, ..setting }
        };
        // Planks of 0.2 m, each of its own brown, with a grain along them.
        let planks = |x: u32, y: u32, shade: f64| {
            let draw = |number: u32| f64::from(number.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
            let light = 0.7 + 0.6 * draw(y / 100 + 1) + 0.3 * draw(x / 8 + 4096 * y);
            if shade > 120.0 { [shade; 3] } else { [105.0, 70.0, 40.0].map(|part| part * light) }
        };
        let shifts: Vec<Shift<'_>> = vec![
            ("as learned", Box::new(|s| s)),
            ("light of 10 %", Box::new(|s| light(s, 0.1))),
            ("light of 25 %", Box::new(|s| light(s, 0.25))),
            ("light of 300 %", Box::new(|s| light(s, 3.0))),
            ("thrice the noise", Box::new(|s| noise(s, 3.0))),
            ("grey paint", Box::new(|s| s.recoloured(|_, _, shade| [0.4 * shade + 30.0; 3]))),
            ("a floor of planks", Box::new(|s| s.recoloured(planks))),
            ("black lines on white", Box::new(|s| s.recoloured(|_, _, shade| [255.0 - shade; 3]))),
            ("80 degrees", Box::new(|s| lens(s, 80.0, false, -25.0))),
            ("110 degrees", Box::new(|s| lens(s, 110.0, false, -25.0))),
            ("a fisheye of 150 degrees", Box::new(|s| lens(s, 150.0, true, -25.0))),
            ("tilted 5 degrees less", Box::new(|s| lens(s, 95.0, false, -20.0))),
        ];
        for (name, shift) in &shifts {
            let scores = (1..=8).map(|seed| shift(Setting::unseen(seed, 0.002)).drive(&network, 30.0));
            let sums = Sums::of(scores);
            sums.print(name);
            assert!(*name != "as learned" || sums.autonomy() >= 99.0, "{sums:?}");
        }
    }
}
