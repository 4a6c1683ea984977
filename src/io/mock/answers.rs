use image::RgbImage;

use super::call::Call;
use super::ideal::IdealDrive;
use super::robot::{MockRobot, take_due, unscripted};
use crate::geometry::{Pose, Twist, Vector3};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, Display, DisplayImage, DisplayOption, DistanceSensors, Drive,
    Encoders, Error, ErrorKind, Fill, Font, Inertial, Key, Keys, Lidar, LidarScan, LidarSettings, Manoeuvres,
    Motors, Odometry, Pixel, Psd, Radio, RadioMessage, Resolution, Result, Servos, StallDetector, Viewport,
};
use crate::kinematics::Displacement;
use crate::parameter::require_finite;
use crate::world::Colour;

impl Clock for MockRobot {
    fn now(&mut self) -> Result<f64> {
        self.pass(self.charge);
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.command(Call::Wait(seconds));
        require_finite("waiting time", seconds)?;
        self.pass(seconds);
        Ok(())
    }

    fn peek_time(&mut self) -> Result<f64> {
        Ok(self.time)
    }
}

impl DistanceSensors for MockRobot {
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        let name = sensor.to_string();
        self.read(&name, |robot| robot.distances.get_mut(&sensor), |robot| robot.or_quiet(f64::INFINITY))
    }
}

impl Lidar for MockRobot {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let reading =
            self.read("lidar", |robot| robot.scan.as_mut(), |robot| robot.or_quiet(LidarScan::default()))?;
        *scan = reading;
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        self.command(Call::ConfigureLidar(settings));
        Ok(settings.validate()?)
    }
}

impl Camera for MockRobot {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.command(Call::SetResolution(resolution));
        self.resolution = resolution;
        Ok(())
    }

    fn resolution(&mut self) -> Result<Resolution> {
        self.pass(self.charge);
        Ok(self.resolution)
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let quiet = |robot: &MockRobot| {
            let (width, height) = robot.resolution.dimensions();
            robot.or_quiet(RgbImage::new(width, height))
        };
        *image = self.read("camera", |robot| robot.image.as_mut(), quiet)?;
        Ok(())
    }
}

impl Drive for MockRobot {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.command(Call::SetSpeed(twist));
        self.drive.as_mut().map_or(Ok(()), |drive| drive.set_speed(twist))
    }
}

impl Odometry for MockRobot {
    fn speed(&mut self) -> Result<Twist> {
        self.read(
            "speed",
            |robot| robot.speed.as_mut(),
            |robot| robot.by_drive(IdealDrive::speed, Twist::STOP),
        )
    }

    fn pose(&mut self) -> Result<Pose> {
        self.read(
            "pose",
            |robot| robot.pose.as_mut(),
            |robot| robot.by_drive(IdealDrive::pose, Pose::default()),
        )
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        self.command(Call::SetPose(pose));
        if let Some(drive) = &mut self.drive {
            drive.set_pose(pose);
        }
        Ok(())
    }
}

impl Manoeuvres for MockRobot {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        let motion = Displacement { length: distance, angle: 0.0 };
        self.start(Call::Straight(distance, speed), motion, distance, speed)
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        self.start(Call::Turn(angle, speed), Displacement { length: 0.0, angle }, angle, speed)
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        self.start(Call::Curve(length, angle, speed), Displacement { length, angle }, length, speed)
    }

    fn remaining(&mut self) -> Result<f64> {
        self.read(
            "rest of the manoeuvre",
            |robot| robot.remaining.as_mut(),
            |robot| robot.by_drive(IdealDrive::remaining, 0.0),
        )
    }

    fn is_done(&mut self) -> Result<bool> {
        Ok(self.remaining()? == 0.0)
    }

    fn wait_done(&mut self) -> Result<()> {
        self.command(Call::WaitDone);
        let seconds = self.drive.as_ref().map_or(0.0, IdealDrive::seconds_left);
        self.pass(seconds);
        Ok(())
    }
}

impl StallDetector for MockRobot {
    fn is_stalled(&mut self) -> Result<bool> {
        self.read("stall detector", |robot| robot.stalled.as_mut(), |robot| robot.by_drive(|_| false, false))
    }
}

impl Encoders for MockRobot {
    fn encoder(&mut self, motor: u8) -> Result<i64> {
        let name = format!("encoder {motor}");
        self.read(&name, |robot| robot.encoders.get_mut(&motor), |robot| robot.or_quiet(0))
    }

    fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        self.command(Call::ResetEncoder(motor));
        Ok(())
    }
}

impl DepthSensor for MockRobot {
    fn depth(&mut self) -> Result<f64> {
        self.read("depth sensor", |robot| robot.depth.as_mut(), |robot| robot.or_quiet(0.0))
    }
}

impl Inertial for MockRobot {
    fn attitude(&mut self) -> Result<Attitude> {
        self.read("attitude", |robot| robot.attitude.as_mut(), |robot| robot.or_quiet(Attitude::default()))
    }

    fn turn_rates(&mut self) -> Result<Vector3> {
        self.read("turn rates", |robot| robot.turn_rates.as_mut(), |robot| robot.or_quiet(Vector3::zeros()))
    }

    fn acceleration(&mut self) -> Result<Vector3> {
        let quiet = Vector3::new(0.0, 0.0, 9.81);
        self.read("acceleration", |robot| robot.acceleration.as_mut(), |robot| robot.or_quiet(quiet))
    }
}

impl Motors for MockRobot {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        self.command(Call::SetMotor(motor, fraction));
        Ok(())
    }
}

impl Servos for MockRobot {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        self.command(Call::SetServo(servo, position));
        Ok(())
    }
}

impl Keys for MockRobot {
    fn read_key(&mut self) -> Result<Option<Key>> {
        self.pass(self.charge);
        match &mut self.keys {
            Some(keys) => Ok(take_due(keys, self.time)),
            None => self.or_quiet(None).ok_or_else(|| unscripted("keypad")),
        }
    }

    fn wait_key(&mut self) -> Result<Key> {
        self.command(Call::WaitKey);
        let keys = self.keys.as_mut().ok_or_else(|| unscripted("keypad"))?;
        let (at, key) = keys.pop_front().ok_or_else(|| {
            Error::new(ErrorKind::EndOfLog, "the script of the keypad has no more keys to wait for")
        })?;
        self.pass(at - self.time);
        Ok(key)
    }

    fn read_touch(&mut self) -> Result<Option<Pixel>> {
        self.pass(self.charge);
        match &mut self.touches {
            Some(touches) => Ok(take_due(touches, self.time)),
            None => self.or_quiet(None).ok_or_else(|| unscripted("touch screen")),
        }
    }
}

impl Radio for MockRobot {
    fn radio_id(&mut self) -> Result<u32> {
        self.pass(self.charge);
        self.radio.as_ref().map(|r| r.0).or_else(|| self.or_quiet(1)).ok_or_else(|| unscripted("radio"))
    }

    fn radio_peers(&mut self) -> Result<Vec<u32>> {
        self.pass(self.charge);
        let peers = self.radio.as_ref().map(|r| r.1.clone());
        peers.or_else(|| self.or_quiet(vec![1])).ok_or_else(|| unscripted("radio"))
    }

    fn send(&mut self, to: u32, data: &[u8]) -> Result<()> {
        self.command(Call::Send(to, data.to_vec()));
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<RadioMessage>> {
        self.pass(self.charge);
        if self.radio.is_none() && !self.lenient {
            return Err(unscripted("radio"));
        }
        Ok(take_due(&mut self.messages, self.time))
    }
}

impl Display for MockRobot {
    fn print(&mut self, text: &str) -> Result<()> {
        self.command(Call::Print(text.to_owned()));
        self.display.print(text)
    }

    fn set_cursor(&mut self, row: i32, column: i32) -> Result<()> {
        self.command(Call::SetCursor(row, column));
        self.display.set_cursor(row, column)
    }

    fn cursor(&mut self) -> Result<(i32, i32)> {
        self.pass(self.charge);
        self.display.cursor()
    }

    fn set_text_colours(&mut self, foreground: Colour, background: Colour) -> Result<()> {
        self.command(Call::SetTextColours(foreground, background));
        self.display.set_text_colours(foreground, background)
    }

    fn set_font(&mut self, font: Font) -> Result<()> {
        self.command(Call::SetFont(font));
        self.display.set_font(font)
    }

    fn clear_display(&mut self) -> Result<()> {
        self.command(Call::ClearDisplay);
        self.display.clear_display()
    }

    fn display_size(&mut self) -> Result<(i32, i32)> {
        self.pass(self.charge);
        self.display.display_size()
    }

    fn set_pixel(&mut self, at: Pixel, colour: Colour) -> Result<()> {
        self.command(Call::SetPixel(at, colour));
        self.display.set_pixel(at, colour)
    }

    fn pixel(&mut self, at: Pixel) -> Result<Option<Colour>> {
        self.pass(self.charge);
        self.display.pixel(at)
    }

    fn draw_line(&mut self, from: Pixel, to: Pixel, colour: Colour) -> Result<()> {
        self.command(Call::DrawLine(from, to, colour));
        self.display.draw_line(from, to, colour)
    }

    fn draw_rectangle(&mut self, corner: Pixel, opposite: Pixel, colour: Colour, fill: Fill) -> Result<()> {
        self.command(Call::DrawRectangle(corner, opposite, colour, fill));
        self.display.draw_rectangle(corner, opposite, colour, fill)
    }

    fn draw_circle(&mut self, centre: Pixel, diameter: i32, colour: Colour, fill: Fill) -> Result<()> {
        self.command(Call::DrawCircle(centre, diameter, colour, fill));
        self.display.draw_circle(centre, diameter, colour, fill)
    }

    fn draw_image(&mut self, picture: DisplayImage<'_>, viewport: Viewport) -> Result<()> {
        self.command(Call::DrawImage(picture.dimensions(), viewport));
        self.display.draw_image(picture, viewport)
    }

    fn set_menu_label(
        &mut self,
        key: Key,
        label: &str,
        foreground: Colour,
        background: Colour,
    ) -> Result<()> {
        self.command(Call::SetMenuLabel(key, label.to_owned(), foreground, background));
        self.display.set_menu_label(key, label, foreground, background)
    }

    fn set_menu(&mut self, labels: [&str; 4]) -> Result<()> {
        self.command(Call::SetMenu(labels.map(str::to_owned)));
        self.display.set_menu(labels)
    }

    fn set_display_option(&mut self, option: DisplayOption, on: bool) -> Result<()> {
        self.command(Call::SetDisplayOption(option, on));
        self.display.set_display_option(option, on)
    }

    fn refresh(&mut self) -> Result<()> {
        self.command(Call::Refresh);
        self.display.refresh()
    }

    fn screenshot(&mut self) -> Result<RgbImage> {
        self.pass(self.charge);
        self.display.screenshot()
    }
}
