//! What sees lines and signs, and what learned to.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use crate::Sample;
use crate::sample::{samples, varied};
use roverlab::vision::lane_markings::{MarkingFilter, RoadCamera};
use roverlab::vision::network::{Architecture, Network};
use roverlab::vision::signs::{SignDescriptor, SignModel};

varied! {
    RoadCamera => varied [
        RoadCamera { field_of_view: 1.0, fisheye: false, tilt: -0.3, height: 0.15, ahead: 0.1 },
        RoadCamera { field_of_view: 3.2, fisheye: true, tilt: -0.8, height: 0.15, ahead: 0.1 }
    ];
}

/// A network with equal weights.
fn network(architecture: &str, weight: f32) -> Option<Network> {
    let architecture: Architecture = architecture.parse().ok()?;
    let filters = architecture.filters().flatten();
    let weights = filters.map(|(count, taps)| (vec![weight; count * taps], vec![weight; count])).collect();
    Network::new(architecture, weights).ok()
}

/// A filter of a camera that `change` may spoil.
fn filter(line_width: f64, reach: f64, change: impl FnOnce(&mut RoadCamera)) -> Option<MarkingFilter> {
    let mut camera = RoadCamera::nth(0)?;
    change(&mut camera);
    MarkingFilter::new(camera, line_width, reach).ok()
}

/// Number of features of a window of the detector, as its file has it.
const WINDOW: usize = 900;

/// The file of a model with equal weights.
fn model(names: &[&str], weight: f32, finds: bool) -> Option<SignModel> {
    let classes = names.len();
    let rows = classes + usize::from(finds);
    let mut tensors = vec![("signs", rows, SignDescriptor::FEATURES + 1)];
    if finds {
        tensors.extend([("windows.any", 1, WINDOW + 1), ("windows.each", classes, WINDOW + 1)]);
    }
    let mut header = format!(r#"{{"__metadata__":{{"classes":"{}"}}"#, names.join("\\n"));
    let mut data = Vec::new();
    for (name, rows, columns) in tensors {
        let from = data.len();
        data.extend(std::iter::repeat_n(weight.to_le_bytes(), rows * columns).flatten());
        let to = data.len();
        let shape = format!(r#""dtype":"F32","shape":[{rows},{columns}]"#);
        let _ = write!(header, r#","{name}":{{{shape},"data_offsets":[{from},{to}]}}"#);
    }
    header.push('}');
    let mut file = (header.len() as u64).to_le_bytes().to_vec();
    file.extend_from_slice(header.as_bytes());
    file.extend(data);
    SignModel::from_safetensors(&file).ok()
}

samples! {
    Network => [
        network("8x8x1 conv2/3/1 pool2 dense4 dense1", 0.1)?, network("1x1x1 dense1", f32::MAX)?,
        network("8x8x1 dense3", 0.0)?, network("32x32x3 conv4/5/2 pool2 dense2", -0.1)?,
        network("32x32x3 dense2", f32::MAX)?
    ];
    Architecture => [
        "8x8x1 conv2/3/1 pool2 dense4 dense1".parse().ok()?, "1x1x1 dense1".parse().ok()?,
        "8x8x1 dense3".parse().ok()?, "32x32x3 conv4/5/2 pool2 dense2".parse().ok()?,
        "790x790x1 dense1".parse().ok()?,
        "4000x1x1 conv1/1/4000 dense2400 dense4000".parse().ok()?
    ];
    MarkingFilter => [
        filter(0.02, 1.5, |_| ())?, filter(0.005, 2.5, |_| ())?, filter(0.2, 100.0, |_| ())?,
        filter(0.02, 1.5, |camera| camera.height = 1e300)?,
        filter(0.02, 1.5, |camera| camera.height = 1e-300)?,
        filter(0.02, 1.5, |camera| camera.ahead = -1e300)?, filter(0.02, 1.5, |camera| camera.ahead = 1e300)?,
        filter(0.02, 1.5, |camera| camera.tilt = 1.49)?, filter(0.02, 1.5, |camera| camera.tilt = -1.49)?,
        filter(0.02, 1.5, |camera| camera.field_of_view = 1e-300)?,
        filter(0.02, 1.5, |camera| camera.field_of_view = PI - 1e-9)?,
        filter(0.02, 1.5, |camera| (camera.fisheye, camera.field_of_view) = (true, TAU - 1e-9))?
    ];
    SignModel => [
        model(&["stop", "give way"], 0.01, true)?, model(&["stop", "give way"], -0.01, false)?,
        model(&["stop", "stop"], 0.0, true)?, model(&["", "😀"], f32::MAX, true)?,
        model(&["stop"], -f32::MAX, true)?, model(&["stop", "give way"], 1e-45, false)?,
        SignModel::nth(0)?.with_network(Network::nth(3)?).ok()?,
        SignModel::nth(1)?.with_network(Network::nth(4)?).ok()?
    ];
}

/// Whether the samples of which the others are made exist.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_have_windows_and_networks() {
        let finds = |index| SignModel::nth(index).unwrap().finds();
        assert_eq!([0, 1, 6, 7].map(finds), [true, false, true, false]);
    }
}
