//! Compares calls of a model in the program itself with calls of an exported one.

use htex_ar::Autoregression;
use htex_host::{Band, FitCondition, FitInput, HostError, Origin, Registry, Status};

#[test]
fn a_registered_model_equals_the_built_in_one_bit_for_bit() {
    let mut registry = Registry::builtin();
    registry.add_model::<Autoregression>().unwrap();
    let own = registry.find("ar").unwrap().clone();
    assert_eq!(*own.origin(), Origin::Own);
    let builtin = Registry::builtin().find("ar").unwrap().clone();
    assert_eq!(own.descriptor(), builtin.descriptor());

    let grid_hz = Band::TACTILE.grid_hz();
    let magnitude: Vec<f64> = grid_hz.iter().map(|hz| 1.0 / (100.0 + hz)).collect();
    let options = own.descriptor().default_options();
    let request = FitInput {
        band: Band::TACTILE,
        frequency_hz: &grid_hz,
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: 20_000.0,
        options: &options,
        condition: FitCondition::default(),
    };
    let fit = own.fit(&request).unwrap();
    assert_eq!(fit, builtin.fit(&request).unwrap());

    let played = [own, builtin].map(|model| {
        let rate_hz = model.voice_rate_hz(&fit.parameters, Band::TACTILE, 20_000.0).unwrap();
        let mut voice = model.voice(&fit.parameters, Band::TACTILE, rate_hz, 7).unwrap();
        let mut out = vec![0.0; 2_000];
        voice.render(&mut out).unwrap();
        voice.free_and_keep_handle().unwrap();
        let freed = voice.render(&mut [0.0]).unwrap_err();
        assert!(matches!(freed, HostError::Call { status: Status::BadHandle, .. }), "{freed}");
        out.into_iter().map(f32::to_bits).collect::<Vec<_>>()
    });
    assert_eq!(played[0], played[1]);
}
