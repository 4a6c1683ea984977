use crate::random::Stream;
use crate::world::DepthSensorSpec;

/// A robot's pressure sensor.
#[derive(Debug)]
pub(super) struct DepthGauge {
    pub(super) spec: DepthSensorSpec,
    /// Constant error (standard deviations).
    bias: f64,
    stream: Stream,
}

impl DepthGauge {
    pub(super) fn new(spec: DepthSensorSpec, mut stream: Stream) -> Self {
        Self { spec, bias: stream.normal(), stream }
    }

    /// A depth with its errors.
    pub(super) fn read(&mut self, depth: f64, sigma: f64) -> f64 {
        if sigma == 0.0 { depth } else { (depth + sigma * (self.bias + self.stream.normal())).max(0.0) }
    }
}
