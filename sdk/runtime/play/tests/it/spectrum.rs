//! A voice states the same magnitudes as its asset does for the same motion, with the voice's own
//! options.

use htex_play::{Effects, Motion, Parameter, Texture, VoiceOptions};

const FREQUENCY_HZ: [f64; 4] = [40.0, 100.0, 250.0, 700.0];

fn vinyl() -> Texture {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/scenes/vinyl.htex");
    Texture::open(file).unwrap()
}

#[test]
fn a_voice_has_the_spectrum_of_its_motion() {
    let asset = vinyl();
    let close = |plays: &[f64], stated: &[f64], gain: f64| {
        let pairs = plays.iter().zip(stated);
        pairs.fold(0.0_f64, |most, (p, s)| most.max((p - gain * s).abs())) < 1e-12
    };
    for representation in &asset.manifest().representations {
        let representation = asset.representation(&representation.model[..]).unwrap();
        let options = VoiceOptions::default().with_gain(0.5);
        let mut voice = representation.voice(&options).unwrap();
        let first = representation.magnitude(None, &FREQUENCY_HZ).unwrap();
        assert!(close(&voice.magnitude(&FREQUENCY_HZ).unwrap(), &first, 0.5));
        for motion in [Motion::new(40.0, 0.2), Motion::new(300.0, 1.5)] {
            voice.set_motion(motion).unwrap();
            voice.set_gain(2.0).unwrap();
            let stated = representation.magnitude(Some(motion), &FREQUENCY_HZ).unwrap();
            assert!(close(&voice.magnitude(&FREQUENCY_HZ).unwrap(), &stated, 2.0));
            assert_eq!(voice.motion(), motion);
        }
        voice.set_motion(Motion::new(0.0, 0.4)).unwrap();
        assert_eq!(voice.magnitude(&FREQUENCY_HZ).unwrap(), [0.0; 4]);
        // Without effects the voice plays as recorded at any motion.
        let options = options.with_gain(1.0).with_effects(Effects::NONE);
        let mut plain = representation.voice(&options).unwrap();
        plain.set_motion(Motion::new(300.0, 1.5)).unwrap();
        assert!(close(&plain.magnitude(&FREQUENCY_HZ).unwrap(), &first, 1.0));
    }
}

#[test]
fn parameters_have_the_names_of_the_fields() {
    let asset = vinyl();
    for representation in &asset.manifest().representations {
        let representation = asset.representation(&representation.model[..]).unwrap();
        let (flat, _) = representation.parameters(None).unwrap();
        let named = representation.named_parameters(None).unwrap();
        let fields = &representation.model().unwrap().descriptor().fields.clone();
        assert!(named.iter().map(|(name, _)| name).eq(fields.iter().map(|f| &f.name)));
        let numbers = named.into_iter().flat_map(|(_, parameter)| match parameter {
            Parameter::Number(number) => vec![number],
            Parameter::List(list) => [vec![list.len() as f64], list].concat(),
        });
        assert_eq!(numbers.collect::<Vec<_>>(), flat);
    }
}
