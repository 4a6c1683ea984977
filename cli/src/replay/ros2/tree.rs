use std::collections::BTreeMap;

use roverlab::geometry::Pose;

use super::messages::TfMessage;

/// Fixed transforms between frames.
#[derive(Debug, Default)]
pub(super) struct FrameTree {
    /// Parent and place of each frame, and whether it is level.
    frames: BTreeMap<String, (String, Option<Pose>)>,
}

/// Number of frames between a sensor and the robot, at most: frames may go round in a circle.
const DEPTH: usize = 64;

impl FrameTree {
    /// Adds the transforms of a message. Those that are tilted have no place on the floor.
    pub(super) fn add(&mut self, message: TfMessage) {
        for stamped in message.transforms {
            let place = stamped.transform.planar().filter(|_| stamped.transform.is_level());
            let [parent, child] = [stamped.header.frame_id, stamped.child_frame_id].map(|name| bare(&name));
            self.frames.insert(child, (parent, place));
        }
    }

    /// Where a frame is in that of the robot, or in the outermost one. `None` if it is not known; fails if it
    /// is tilted.
    pub(super) fn mount(&self, frame: &str, base: Option<&str>) -> Result<Option<Pose>, String> {
        let (mut frame, base) = (bare(frame), base.map(bare));
        let mut place = Pose::default();
        for _ in 0..DEPTH {
            if base.as_ref() == Some(&frame) {
                return Ok(Some(place));
            }
            let Some((parent, pose)) = self.frames.get(&frame) else { break };
            let Some(pose) = pose else {
                return Err(format!("found the frame {frame:?} tilted in {parent:?}; expected a level one"));
            };
            place = pose.compose(&place);
            frame.clone_from(parent);
        }
        Ok((base.is_none() && place != Pose::default()).then_some(place))
    }
}

/// A frame's name without the slash that old ones begin with.
fn bare(name: &str) -> String {
    name.trim_start_matches('/').to_owned()
}
