use std::f64::consts::TAU;

use roverlab::geometry::{Pose, units};
use roverlab::io::{Error, LidarSettings, Resolution, Result};

use super::{Robios, images, in_whole, invalid, millimetres, pose_from};
use crate::ask::{Reply, Request};

/// RoBIOS's reading for nothing in range.
pub const NOTHING: i32 = 9999;

/// Default duration of an image (s), for 30 images per second.
const FRAME: f64 = 0.033;

impl Robios {
    /// `PSDGet`: at least 1 mm, as 0 means a missing sensor.
    pub fn psd_get(&mut self, psd: i32) -> Result<i32> {
        let number = u8::try_from(psd).map_err(|_| invalid("PSD", psd, "0 to 255"))?;
        Ok(range(self.number(&Request::Distance(number))?).max(1))
    }

    /// Number of distances that `LIDARGet` writes.
    pub fn lidar_points(&self) -> usize {
        self.identity.lidar_points as usize
    }

    /// `LIDARGet`: clockwise from behind.
    pub fn lidar_get(&mut self) -> Result<Vec<i32>> {
        let Reply::Ranges(ranges) = self.ask(&Request::Scan)? else { return Err(super::foreign()) };
        let mut distances: Vec<i32> = ranges.into_iter().map(range).collect();
        distances.reverse();
        if self.identity.full_turn {
            // The simulator's scan begins behind, so its last beam becomes the second one here.
            distances.rotate_right(1);
        }
        Ok(distances)
    }

    /// `LIDARSet`: field of view (degrees), downward tilt (degrees), and number of beams.
    pub fn lidar_set(&mut self, angle: i32, tilt: i32, points: i32) -> Result<()> {
        let count = usize::try_from(points).ok().filter(|&n| (1..=LidarSettings::MAX_POINTS).contains(&n));
        let points = count.ok_or_else(|| invalid("lidar points", points, "1 to 100000"))?;
        if !(1..=360).contains(&angle) {
            return Err(invalid("lidar range", angle, "1 to 360 degrees"));
        }
        if !(-90..=90).contains(&tilt) {
            return Err(invalid("lidar tilt", tilt, "-90 to 90 degrees"));
        }
        if self.identity.lidar_points == 0 {
            return Err(Error::unsupported("lidar"));
        }
        let field_of_view = if angle == 360 { TAU } else { units::from_deg(angle.into()) };
        let tilt = -units::from_deg(tilt.into());
        self.order(&Request::ConfigureLidar(LidarSettings { field_of_view, tilt, points }))?;
        self.identity.lidar_points = points as u32;
        self.identity.full_turn = angle == 360;
        Ok(())
    }

    /// `CAMInit`.
    pub fn cam_init(&mut self, resolution: i32) -> Result<(usize, usize)> {
        let found = usize::try_from(resolution).ok().and_then(|n| Resolution::ALL.get(n).copied());
        let found = found.ok_or_else(|| invalid("camera resolution", resolution, "0 to 5"))?;
        if !self.identity.camera {
            return Err(Error::unsupported("camera"));
        }
        self.order(&Request::SetResolution(resolution as u8))?;
        self.camera = Some(found);
        self.image_size = images::size(found);
        self.image_size_set = true;
        Ok(self.image_size)
    }

    /// `CAMRelease`.
    pub fn cam_release(&mut self) -> Result<()> {
        self.camera = None;
        self.charge()
    }

    /// `CAMGet`. Fails before `CAMInit`, as the size of the program's memory is unknown.
    pub fn cam_get(&mut self) -> Result<Vec<u8>> {
        if self.camera.is_none() {
            return Err(invalid("camera", "off", "CAMInit before"));
        }
        let image = self.image()?;
        if !self.has_frames() {
            self.pass(FRAME)?;
        }
        Ok(image.into_raw())
    }

    /// `CAMGetGray`.
    pub fn cam_get_gray(&mut self) -> Result<Vec<u8>> {
        let colour = self.cam_get()?;
        let Some(size) = self.camera.map(images::size) else { return Ok(Vec::new()) };
        let mut gray = vec![0; size.0 * size.1];
        images::gray(&colour, &mut gray, size);
        Ok(gray)
    }

    /// `IPSetSize`.
    pub fn ip_set_size(&mut self, resolution: i32) -> Result<(usize, usize)> {
        self.image_size = images::named_size(resolution)?;
        self.image_size_set = true;
        self.charge()?;
        Ok(self.image_size)
    }

    /// Number of columns and rows of images for the image processing functions.
    pub fn image_size(&self) -> (usize, usize) {
        self.image_size
    }

    /// `SIMGetRobot`; 0 is the robot itself.
    pub fn sim_get_robot(&mut self, id: i32) -> Result<[i32; 4]> {
        self.report.note_beyond("SIMGetRobot");
        let id = u32::try_from(id).map_err(|_| invalid("robot", id, "0 or more"))?;
        Ok(placed(self.pose_of(&Request::RobotAt(id))?))
    }

    /// `SIMSetRobot`: x, y, z and phi. On hills the robot drops from z, unless the ground is higher; on a
    /// level floor its height stays.
    pub fn sim_set_robot(&mut self, id: i32, [x, y, z, phi]: [i32; 4]) -> Result<()> {
        self.report.note_beyond("SIMSetRobot");
        let id = u32::try_from(id).map_err(|_| invalid("robot", id, "0 or more"))?;
        let z = units::from_mm(f64::from(z));
        self.order(&Request::PlaceRobot(id, pose_from([x, y, phi]), z))
    }

    /// `SIMGetObject`, numbered from 1.
    pub fn sim_get_object(&mut self, id: i32) -> Result<[i32; 4]> {
        self.report.note_beyond("SIMGetObject");
        let id = u32::try_from(id).map_err(|_| invalid("object", id, "1 or more"))?;
        Ok(placed(self.pose_of(&Request::ObjectAt(id))?))
    }

    /// `SIMSetObject`.
    pub fn sim_set_object(&mut self, id: i32, pose: [i32; 3]) -> Result<()> {
        self.report.note_beyond("SIMSetObject");
        let id = u32::try_from(id).map_err(|_| invalid("object", id, "1 or more"))?;
        self.order(&Request::PlaceObject(id, pose_from(pose)))
    }
}

fn range(metres: f64) -> i32 {
    if metres.is_finite() { millimetres(metres).clamp(0, NOTHING) } else { NOTHING }
}

fn placed((pose, elevation): (Pose, f64)) -> [i32; 4] {
    let [x, y, phi] = in_whole(pose);
    [x, y, millimetres(elevation), phi]
}
