//! Weights of signs, and networks. What is read can be written; weights of signs come back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::vision::network::Network;
use roverlab::vision::signs::SignModel;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(network) = Network::from_safetensors(bytes) {
        network.to_safetensors().expect("what was read is written");
    }
    if let Ok(model) = SignModel::from_safetensors(bytes) {
        let written = model.to_safetensors().expect("what was read is written");
        assert_eq!(SignModel::from_safetensors(&written), Ok(model));
    }
});
