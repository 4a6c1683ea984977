//! Capabilities of a simulated robot, shared by blocking robots and members of a fleet.

use super::engine::Engine;
use super::{FleetRobot, SimRobot};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, ErrorKind, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres,
    Motors, Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::kinematics::Displacement;
use crate::world::Colour;
use image::RgbImage;

/// Answers when the running manoeuvre has ended or stalled.
#[allow(clippy::unnecessary_wraps, reason = "Other questions that a poll asks may fail")]
fn arrival(engine: &mut Engine, index: usize) -> Result<Option<()>> {
    let done = engine.machines[index].drive.get().is_done() || engine.bodies[index].touch.is_stalled();
    Ok(done.then_some(()))
}

/// Answers with the next key press; fails if none is scheduled.
fn next_key(engine: &mut Engine, index: usize) -> Result<Option<Key>> {
    let now = engine.time();
    let machine = &mut engine.machines[index];
    if machine.keys.is_empty() {
        let message = "the program waits for a key, and no key press is scheduled";
        return Err(Error::new(ErrorKind::Other, message));
    }
    Ok(machine.take_key(now))
}

macro_rules! robot_through_engine {
    ($robot:ty) => {
        impl Clock for $robot {
            fn now(&mut self) -> Result<f64> {
                self.time()
            }

            fn wait(&mut self, seconds: f64) -> Result<()> {
                self.pause(seconds)
            }

            fn peek_time(&mut self) -> Result<f64> {
                Ok(self.own_time())
            }
        }

        impl Drive for $robot {
            fn set_speed(&mut self, twist: Twist) -> Result<()> {
                self.call(|engine, i| engine.set_twist(i, twist))
            }
        }

        impl Odometry for $robot {
            fn speed(&mut self) -> Result<Twist> {
                self.call(|engine, i| Ok(engine.machines[i].drive.get().twist()))
            }

            fn pose(&mut self) -> Result<Pose> {
                self.call(|engine, i| Ok(engine.machines[i].drive.get().odometry()))
            }

            fn set_pose(&mut self, pose: Pose) -> Result<()> {
                self.call(|engine, i| engine.set_odometry(i, pose))
            }
        }

        impl Manoeuvres for $robot {
            fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
                self.curve(distance, 0.0, speed)
            }

            fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
                self.curve(0.0, angle, speed)
            }

            fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
                self.call(|engine, i| engine.manoeuvre(i, Displacement { length, angle }, speed))
            }

            fn remaining(&mut self) -> Result<f64> {
                self.call(|engine, i| Ok(engine.machines[i].drive.get().remaining()))
            }

            fn is_done(&mut self) -> Result<bool> {
                self.call(|engine, i| Ok(engine.machines[i].drive.get().is_done()))
            }

            fn wait_done(&mut self) -> Result<()> {
                self.poll(arrival)
            }
        }

        impl StallDetector for $robot {
            fn is_stalled(&mut self) -> Result<bool> {
                self.call(|engine, i| Ok(engine.bodies[i].touch.is_stalled()))
            }
        }

        impl DistanceSensors for $robot {
            fn distance(&mut self, sensor: Psd) -> Result<f64> {
                self.call(|engine, i| engine.psd(i, sensor))
            }
        }

        impl Lidar for $robot {
            fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
                self.call(|engine, i| engine.scan_into(i, scan))
            }

            fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
                self.call(|engine, i| engine.configure_lidar(i, settings))
            }
        }

        impl Camera for $robot {
            fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
                self.call(|engine, i| engine.set_resolution(i, resolution))
            }

            fn resolution(&mut self) -> Result<Resolution> {
                self.call(|engine, i| engine.resolution(i))
            }

            fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
                self.call(|engine, i| engine.image_into(i, image))
            }
        }

        impl Display for $robot {
            fn print(&mut self, text: &str) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().print(text))
            }

            fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_cursor(row, column))
            }

            fn cursor(&mut self) -> Result<(i32, i32)> {
                self.call(|engine, i| engine.machines[i].lcd().cursor())
            }

            fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_text_colours(foreground, background))
            }

            fn set_font(&mut self, font: Font) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_font(font))
            }

            fn clear_display(&mut self) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().clear_display())
            }

            fn display_size(&mut self) -> Result<(i32, i32)> {
                self.call(|engine, i| engine.machines[i].lcd().display_size())
            }

            fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_pixel(at, colour))
            }

            fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>> {
                self.call(|engine, i| engine.machines[i].lcd().pixel(at))
            }

            fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().draw_line(from, to, colour))
            }

            fn draw_rectangle(
                &mut self,
                corner: Pixel,
                opposite: Pixel,
                colour: Colour,
                fill: Fill,
            ) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().draw_rectangle(corner, opposite, colour, fill))
            }

            fn draw_circle(
                &mut self,
                centre: Pixel,
                diameter: i32,
                colour: Colour,
                fill: Fill,
            ) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().draw_circle(centre, diameter, colour, fill))
            }

            fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().draw_image(picture, viewport))
            }

            fn set_menu_label(
                &mut self,
                key: Key,
                label: &str,
                foreground: Colour,
                background: Colour,
            ) -> Result<()> {
                self.call(|engine, i| {
                    engine.machines[i].lcd().set_menu_label(key, label, foreground, background)
                })
            }

            fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_menu(labels))
            }

            fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().set_display_option(option, on))
            }

            fn refresh(&mut self) -> Result<()> {
                self.call(|engine, i| engine.machines[i].lcd().refresh())
            }

            fn screenshot(&mut self) -> Result<RgbImage> {
                self.call(|engine, i| engine.machines[i].lcd().screenshot())
            }
        }

        impl Keys for $robot {
            fn read_key(&mut self) -> Result<Option<Key>> {
                self.call(|engine, i| {
                    let now = engine.time();
                    Ok(engine.machines[i].take_key(now))
                })
            }

            fn wait_key(&mut self) -> Result<Key> {
                self.poll(next_key)
            }

            fn read_touch(&mut self) -> Result<Option<(i32, i32)>> {
                self.call(|_, _| Ok(None))
            }
        }

        impl Radio for $robot {
            fn radio_id(&mut self) -> Result<u32> {
                self.call(|_, i| Ok(i as u32 + 1))
            }

            fn radio_peers(&mut self) -> Result<Vec<u32>> {
                self.call(|engine, _| Ok((1..=engine.bodies.len() as u32).collect()))
            }

            fn send(&mut self, to: u32, data: &[u8]) -> Result<()> {
                self.call(|engine, i| engine.send(i, to, data))
            }

            fn receive(&mut self) -> Result<Option<RadioMessage>> {
                self.call(|engine, i| Ok(engine.machines[i].mailbox.pop_front()))
            }
        }

        impl Motors for $robot {
            fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
                self.call(|engine, i| engine.set_motor(i, motor, fraction))
            }
        }

        impl Servos for $robot {
            fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
                self.call(|engine, i| engine.set_servo(i, servo, position))
            }
        }

        impl Encoders for $robot {
            fn encoder(&mut self, motor: u8) -> Result<i64> {
                self.call(|engine, i| engine.machines[i].encoder(motor))
            }

            fn reset_encoder(&mut self, motor: u8) -> Result<()> {
                self.call(|engine, i| engine.machines[i].reset_encoder(motor))
            }
        }

        impl DepthSensor for $robot {
            fn depth(&mut self) -> Result<f64> {
                self.call(|engine, i| engine.depth(i))
            }
        }

        impl Inertial for $robot {
            fn attitude(&mut self) -> Result<Attitude> {
                self.call(|engine, i| engine.attitude(i))
            }

            fn turn_rates(&mut self) -> Result<Vector3> {
                self.call(|engine, i| engine.turn_rates(i))
            }

            fn acceleration(&mut self) -> Result<Vector3> {
                self.call(|engine, i| engine.acceleration(i))
            }
        }
    };
}

robot_through_engine!(SimRobot);
robot_through_engine!(FleetRobot<'_>);
