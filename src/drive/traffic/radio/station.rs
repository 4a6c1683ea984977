use std::ops::ControlFlow;

use super::car::listen;
use super::message::{CarIntent, CarReport, RoadMessage};
use crate::ParameterError;
use crate::drive::lane_keeping::LaneOutcome;
use crate::geometry::{Aabb, Point};
use crate::io::control::{Behaviour, Command, Decision, Senses};
use crate::io::{Display, Fill, Key, Keys, Pixel, Radio, RadioMessage, Result};
use crate::parameter::require_positive;
use crate::world::Colour;

/// Parameters of a [`RoadStation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadStationParameters {
    /// Control period, and interval between orders, which are repeated as messages are lost (s).
    pub period: f64,
    /// Time after which a car that is not heard any more counts as lost (s).
    pub memory: f64,
}

impl Default for RoadStationParameters {
    /// Five times a second, as cars report.
    fn default() -> Self {
        Self { period: 0.2, memory: 3.0 }
    }
}

/// Observation of a [`RoadStation`].
#[derive(Debug, Clone, Default)]
pub struct RoadStationObservation {
    /// Messages received.
    pub messages: Vec<RadioMessage>,
    /// Numbers of the other robots.
    pub others: Vec<u32>,
    /// Keys pressed.
    pub keys: Vec<Key>,
    /// Width and height of the display (pixels).
    pub display: (i32, i32),
}

/// Command of a [`RoadStation`]: an order to robots, and what it draws.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RoadStationCommand {
    /// The order and its receivers.
    pub order: Option<(Vec<u32>, RoadMessage)>,
    /// Places where cars have been, as pixels.
    trail: Vec<Pixel>,
    /// Cars: pixel, colour, and a line of text.
    cars: Vec<(Pixel, Colour, String)>,
}

/// The base station of cars on a road (book, chapter 13): it draws their trails and where they are on its
/// display, and stops and starts them by its keys [`STOP`](Self::STOP) and [`GO`](Self::GO), or by order of
/// its program.
///
/// Orders are repeated five times a second, so that none is lost for good. A car that is not heard any more
/// is shown in grey.
#[derive(Debug, Clone)]
pub struct RoadStation {
    parameters: RoadStationParameters,
    /// Last reports: number, time (s), and report.
    cars: Vec<(u32, f64, CarReport)>,
    /// Places where cars have been.
    trail: Vec<Point>,
    order: Option<RoadMessage>,
}

/// Distance between drawn places (m).
const CELL: f64 = 0.15;
/// Largest number of drawn places.
const PLACES: usize = 2000;
/// Height of a line of text above the course: a car each (pixels).
const LINE: i32 = 14;
/// Margin around the course (pixels).
const MARGIN: i32 = 6;
/// Diameter of a car (pixels).
const DOT: i32 = 9;
const COLOURS: [u32; 5] = [0xd6_27_28, 0x1f_77_b4, 0x2c_a0_2c, 0xff_7f_0e, 0x94_67_bd];
const LOST: u32 = 0x80_80_80;

impl RoadStation {
    /// Key that stops all cars.
    pub const STOP: Key = Key::Key1;
    /// Key that lets them go on.
    pub const GO: Key = Key::Key2;

    /// Creates a station. Fails for parameters out of range.
    pub fn new(parameters: RoadStationParameters) -> std::result::Result<Self, ParameterError> {
        require_positive("period of the station", parameters.period)?;
        require_positive("memory", parameters.memory)?;
        Ok(Self { parameters, cars: Vec::new(), trail: Vec::new(), order: None })
    }

    /// Orders all cars to stand, or to go on.
    pub fn stop(&mut self, stands: bool) {
        self.order = Some(if stands { RoadMessage::Stop } else { RoadMessage::Go });
    }

    /// Last reports of the cars, by their numbers: number, time (s), and report.
    pub fn cars(&self) -> &[(u32, f64, CarReport)] {
        &self.cars
    }

    fn hear(&mut self, time: f64, from: u32, report: CarReport) {
        match self.cars.binary_search_by_key(&from, |(id, ..)| *id) {
            Ok(index) => self.cars[index] = (from, time, report),
            Err(index) => self.cars.insert(index, (from, time, report)),
        }
        let place = report.pose.position();
        if self.trail.len() < PLACES && self.trail.iter().all(|other| (other - place).norm() > CELL) {
            self.trail.push(place);
        }
    }

    /// What the display shows.
    fn draw(&self, time: f64, (width, height): (i32, i32)) -> (Vec<Pixel>, Vec<(Pixel, Colour, String)>) {
        let lines = LINE * self.cars.len() as i32;
        let area = (width - 2 * MARGIN, height - lines - 2 * MARGIN);
        let Some(course) = Aabb::around(self.trail.iter().copied()) else { return Default::default() };
        let size = course.size();
        let scale = (f64::from(area.0) / size.x.max(1.0)).min(f64::from(area.1) / size.y.max(1.0));
        let pixel = |place: Point| {
            let off = place - course.min;
            (MARGIN + (scale * off.x) as i32, MARGIN + lines + area.1 - (scale * off.y) as i32)
        };
        let cars = self.cars.iter().enumerate().map(|(index, (id, heard, report))| {
            let is_lost = time - heard > self.parameters.memory;
            let colour = if is_lost { LOST } else { COLOURS[index % COLOURS.len()] };
            let what = match report.intent {
                _ if is_lost => "is not heard",
                CarIntent::Drive if report.is_in_lane => "drives",
                CarIntent::Drive => "passes",
                CarIntent::GiveWay => "gives way",
                CarIntent::Stand => "stands",
            };
            (
                pixel(report.pose.position()),
                Colour::from_hex(colour),
                format!("{id} {:.1} {what}", report.speed),
            )
        });
        (self.trail.iter().copied().map(pixel).collect(), cars.collect())
    }
}

impl Behaviour for RoadStation {
    type Observation = RoadStationObservation;
    type Command = RoadStationCommand;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &RoadStationObservation) -> Decision<Self> {
        for RadioMessage { from, data } in &seen.messages {
            if let Some(RoadMessage::Car(report)) = RoadMessage::read(data) {
                self.hear(time, *from, report);
            }
        }
        for key in &seen.keys {
            match *key {
                Self::STOP => self.stop(true),
                Self::GO => self.stop(false),
                _ => {}
            }
        }
        let (trail, cars) = self.draw(time, seen.display);
        let order = self.order.map(|order| (seen.others.clone(), order));
        Ok(ControlFlow::Continue(RoadStationCommand { order, trail, cars }))
    }
}

impl<R: Radio + Display + Keys + ?Sized> Senses<R> for RoadStation {
    fn prepare(&mut self, robot: &mut R) -> Result<()> {
        robot.set_menu(["STOP", "GO", "", ""])
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RoadStationObservation) -> Result<()> {
        (seen.messages, seen.others) = listen(robot)?;
        seen.keys.clear();
        while let Some(key) = robot.read_key()? {
            seen.keys.push(key);
        }
        // The bar of the soft keys is below.
        let (width, height) = robot.display_size()?;
        seen.display = (width, height - 3 * LINE);
        Ok(())
    }
}

impl<R: Radio + Display + ?Sized> Command<R> for RoadStationCommand {
    fn apply(&self, robot: &mut R) -> Result<()> {
        if let Some((receivers, order)) = &self.order {
            let text = order.to_string();
            receivers.iter().try_for_each(|receiver| robot.send(*receiver, text.as_bytes()))?;
        }
        robot.clear_display()?;
        for pixel in &self.trail {
            robot.set_pixel(*pixel, Colour::WHITE)?;
        }
        for (row, (pixel, colour, text)) in self.cars.iter().enumerate() {
            robot.draw_circle(*pixel, DOT, *colour, Fill::Solid)?;
            robot.set_text_colours(*colour, Colour::BLACK)?;
            robot.print_at(row as i32, 0, text)?;
        }
        Ok(())
    }

    fn stop(_robot: &mut R) -> Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    fn seen(text: &str, keys: &[Key]) -> RoadStationObservation {
        let messages = vec![RadioMessage { from: 3, data: text.as_bytes().to_vec() }];
        RoadStationObservation { messages, others: vec![1, 3], keys: keys.to_vec(), display: (480, 300) }
    }

    fn step(station: &mut RoadStation, time: f64, seen: &RoadStationObservation) -> RoadStationCommand {
        let ControlFlow::Continue(command) = station.step(time, seen).unwrap() else { panic!("it goes on") };
        command
    }

    #[test]
    fn cars_are_drawn_until_they_are_lost_and_keys_stop_them() {
        let mut station = RoadStation::new(RoadStationParameters::default()).unwrap();
        let report = CarReport {
            pose: Pose::new(2.0, 1.0, 0.0),
            speed: 0.5,
            curvature: 0.0,
            is_in_lane: true,
            intent: CarIntent::Drive,
        };
        let text = RoadMessage::Car(report).to_string();
        let drawn = step(&mut station, 1.0, &seen(&text, &[]));
        assert_eq!((drawn.order.clone(), drawn.cars.len(), drawn.trail.len()), (None, 1, 1), "{drawn:?}");
        assert_eq!(drawn.cars[0].2, "3 0.5 drives");
        let ((x, y), ..) = drawn.cars[0];
        assert!((0..480).contains(&x) && (0..300).contains(&y));
        let drawn = step(&mut station, 9.0, &seen("other", &[RoadStation::STOP]));
        assert_eq!(drawn.cars[0].2, "3 0.5 is not heard");
        assert_eq!(drawn.order, Some((vec![1, 3], RoadMessage::Stop)));
        let again = step(&mut station, 9.2, &seen("other", &[]));
        assert_eq!(again.order, drawn.order, "orders are repeated");
        let drawn = step(&mut station, 9.4, &seen("other", &[RoadStation::GO]));
        assert_eq!(drawn.order, Some((vec![1, 3], RoadMessage::Go)));
    }
}
