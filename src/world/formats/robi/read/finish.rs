//! The robot that the lines of a `.robi` file describe together.

use std::sync::Arc;

use super::super::super::error::{FormatError, Location, Parsed};
use super::super::super::limits::MAX_METRES;
use super::super::super::number::MILLI;
use super::super::craft::CraftLines;
use super::super::mounts::{self, Columns};
use super::super::parts::Wheel;
use super::{DEFAULT_HEIGHT, Drive, Reader};
use crate::geometry::units;
use crate::world::formats::number;
use crate::world::{Body, DriveSpec, Footprint, Mount, PsdSpec, RobotSpec};

impl Reader<'_> {
    pub(super) fn finish(mut self) -> Result<Parsed<RobotSpec>, FormatError> {
        let Some(drive) = self.drive else {
            let (found, expected) = ("no `drive` line", "`drive` and the name of a drive");
            return Err(FormatError::new(self.notes.file, Location::START, found, expected));
        };
        // What has no wheels does not drive.
        let drive = match (drive, self.wheel) {
            (Drive::Unknown, Some(_)) => Drive::Differential,
            (Drive::Unknown, None) => Drive::Submarine,
            (known, _) => known,
        };
        self.spec.drive = self.drive_spec(drive)?;
        self.place_sensors();
        self.place_footprint(drive);
        self.place_mast()?;
        // Wheels, outline and axle may each be within their limits, but not their combination.
        let reach = self.spec.footprint.bounding_radius() + self.spec.body.axle[0].abs();
        if reach > 0.5 * MAX_METRES {
            let found = format!("a robot that reaches {} mm from its middle", number::print(reach, MILLI));
            let expected = "at most 500000000";
            return Err(FormatError::new(self.notes.file, Location::START, found, expected));
        }
        Ok(self.notes.finish(self.spec))
    }

    fn drive_spec(&mut self, drive: Drive) -> Result<DriveSpec, FormatError> {
        if matches!(drive, Drive::Submarine | Drive::Boat) {
            self.spec.body.turn_axle_height = 0.0;
            let lines = std::mem::take(&mut self.craft);
            let craft = lines.finish(drive == Drive::Boat, &self.spec, &mut self.notes)?;
            return Ok(DriveSpec::Craft(Arc::new(craft)));
        }
        let wheel = self.wheel.unwrap_or_else(|| {
            self.notes.warn(Location::START, "no `wheel` line; the wheels of an S4 are taken");
            Wheel { diameter: 0.054, max_speed: units::from_deg(3600.0), ticks: 1100.0, track: 0.090 }
        });
        let Wheel { diameter: wheel_diameter, max_speed: max_wheel_speed, ticks: ticks_per_turn, track } =
            wheel;
        if drive == Drive::Differential {
            // Nothing is steered.
            self.spec.body.turn_axle_height = 0.0;
            return Ok(DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn });
        }
        if drive == Drive::Tracked {
            self.spec.body.turn_axle_height = 0.0;
            let [length, width] = self.belts(track)?;
            return Ok(DriveSpec::Tracked {
                wheel_diameter,
                track,
                length,
                width,
                max_wheel_speed,
                ticks_per_turn,
            });
        }
        let ahead = self.spec.body.axle[0];
        let wheelbase = self.turn_axle.unwrap_or(ahead + track) - ahead;
        if self.turn_axle.is_none() && drive == Drive::Ackermann {
            self.notes.warn(Location::START, "no `axel turn` line; the axles are as far apart as the wheels");
        }
        if wheelbase <= 0.0 || wheelbase > MAX_METRES {
            let found = format!("axles {} mm apart", number::print(wheelbase, MILLI));
            return Err(FormatError::new(
                self.notes.file,
                Location::START,
                found,
                "the steered axle before the driven one",
            ));
        }
        Ok(match drive {
            Drive::Omni => {
                DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn }
            }
            _ => DriveSpec::Ackermann {
                wheel_diameter,
                track,
                wheelbase,
                max_steering: self.steering,
                max_wheel_speed,
                ticks_per_turn,
                dynamics: self.dynamics,
            },
        })
    }

    /// Length and width of the belts.
    fn belts(&mut self, track: f64) -> Result<[f64; 2], FormatError> {
        let [length, width] = self.tracks.unwrap_or_else(|| {
            let message = "no `tracks` line; the belts are half as long again as they are apart";
            self.notes.warn(Location::START, message);
            [1.5 * track, 0.3 * track]
        });
        if width <= track {
            return Ok([length, width]);
        }
        let found = format!("belts {} mm wide", number::print(width, MILLI));
        let expected = "belts no wider than they are apart";
        Err(FormatError::new(self.notes.file, Location::START, found, expected))
    }

    fn place_sensors(&mut self) {
        let ahead = self.spec.body.axle[0];
        let shared = self.psds.iter().filter(|psd| psd.shared).map(|psd| (psd.name.as_str(), psd.raw));
        let columns = mounts::columns(&shared);
        for psd in std::mem::take(&mut self.psds) {
            let columns = if psd.shared { columns } else { Columns::ForwardLeftUp };
            let mount = Mount { roll: 0.0, ..psd.raw.mount(columns, &psd.name, ahead) };
            self.spec.psds.push(PsdSpec { id: psd.id, name: psd.name, mount, max_range: psd.max_range });
        }
        if let Some(lidar) = &mut self.spec.lidar {
            if let Some(raw) = self.lidar_mount {
                lidar.mount = raw.mount(columns, "", ahead);
            }
            lidar.max_range = self.lidar_range.unwrap_or(lidar.max_range);
        }
        match (&mut self.spec.camera, self.camera_place) {
            (Some(camera), Some(place)) => {
                camera.mount = Mount { yaw: camera.mount.yaw, ..mounts::camera_place(place, ahead) };
                if let Some((view, fisheye)) = self.camera_view {
                    (camera.field_of_view, camera.fisheye) = (view, fisheye);
                }
            }
            _ if self.camera_view.is_some() => {
                self.notes.warn(Location::START, "a lens without a `camera` line; ignored");
            }
            _ => {}
        }
    }

    fn place_footprint(&mut self, drive: Drive) {
        let body = &mut self.spec.body;
        let derived = body.footprint(matches!(drive, Drive::Differential | Drive::Tracked));
        let wheels = match self.spec.drive {
            DriveSpec::Differential { wheel_diameter, track, .. }
            | DriveSpec::Ackermann { wheel_diameter, track, .. }
            | DriveSpec::Tracked { wheel_diameter, track, .. }
            | DriveSpec::Omni { wheel_diameter, track, .. } => 0.5 * (track + wheel_diameter),
            DriveSpec::Craft(ref craft) => CraftLines::radius(craft),
        };
        let fallback = (Footprint::Disc { radius: wheels }, DEFAULT_HEIGHT);
        (self.spec.footprint, self.spec.height) = self.outline.take().or(derived).unwrap_or(fallback);
        if says_all(body, &self.spec.footprint, self.spec.height) {
            body.colliders.clear();
        }
    }

    fn place_mast(&mut self) -> Result<(), FormatError> {
        let Some((mast, at)) = self.mast else { return Ok(()) };
        self.spec.mast = Some(mast);
        let wrong = |error: crate::ParameterError| {
            FormatError::new(self.notes.file, at, error.to_string(), "a mast that stands on the robot")
        };
        self.spec.validate_mast().map_err(wrong)
    }
}

/// Whether footprint and height describe the colliders completely.
fn says_all(body: &Body, footprint: &Footprint, height: f64) -> bool {
    *body.colliders == [body.collider_of_footprint(footprint, height)]
}
