//! Haptic textures for Bevy: assets, components and a plugin.

use bevy_app::prelude::*;
use bevy_asset::io::Reader;
use bevy_asset::{Asset, AssetApp, AssetLoader, Assets, Handle, LoadContext};
use bevy_ecs::prelude::*;
use bevy_platform::cell::SyncCell;
use bevy_reflect::TypePath;
use htex::library::Library;
use htex::{Motion, Texture, Voice, VoiceOptions};

/// Sample rate, hertz.
pub const RATE_HZ: u32 = 48_000;
/// Number of samples that each tick renders: 10 ms.
pub const BLOCK: usize = 480;

/// A texture: `cloth.htex`, or `cloth.htexlib#oak` for the texture `oak` of a library.
#[derive(Asset, TypePath)]
pub struct HapticTexture(pub Texture);

/// A library of textures, all of which it loads: `cloth.htexlib`.
#[derive(Asset, TypePath)]
pub struct HapticLibrary(#[dependency] pub Vec<Handle<HapticTexture>>);

/// The texture of an entity.
#[derive(Component)]
#[require(Slide)]
pub struct Surface(pub Handle<HapticTexture>);

/// The motion of the finger over an entity. The default is a finger that does not touch it.
#[derive(Component, Clone, Copy, Default)]
pub struct Slide {
    pub speed_mm_s: f64,
    pub force_n: f64,
}

/// The voice of an entity. The plugin adds this component when the texture of the entity is loaded.
#[derive(Component)]
pub struct Playing(SyncCell<Voice>);

/// The last block of samples: the sum of all voices, relative to full scale.
///
/// Ticks are too irregular for a sound card. A real app therefore sends each new voice to the audio
/// thread of cpal or rodio, and then sends only motions: see `../app-rust-rodio`.
#[derive(Resource)]
pub struct Block(pub [f32; BLOCK]);

/// Loads textures, and plays them in the schedule [`Update`].
pub struct HapticsPlugin;

/// The system that renders a [`Block`].
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Render;

impl Plugin for HapticsPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<HapticTexture>()
            .init_asset::<HapticLibrary>()
            .register_asset_loader(TextureLoader)
            .register_asset_loader(LibraryLoader)
            .insert_resource(Block([0.0; BLOCK]))
            .add_systems(Update, (make_voices, render.in_set(Render)).chain())
            .add_observer(drop_voice);
    }
}

/// Makes a voice for each entity whose texture is loaded.
fn make_voices(
    mut commands: Commands,
    textures: Res<Assets<HapticTexture>>,
    surfaces: Query<(Entity, &Surface), Without<Playing>>,
) -> Result {
    for (entity, Surface(handle)) in &surfaces {
        let Some(HapticTexture(texture)) = textures.get(handle) else { continue };
        // Samples are in the unit of the texture, such as newtons. A sound card expects samples from
        // -1 to 1.
        let options = VoiceOptions::default()
            .with_rate_hz(RATE_HZ.into())
            .with_gain(0.1 / texture.level_rms(None)?)
            .with_limit(0.9);
        let voice = texture.voice(&options)?;
        commands.entity(entity).insert(Playing(SyncCell::new(voice)));
    }
    Ok(())
}

/// Passes the motions to the voices, and renders the next block.
fn render(mut block: ResMut<Block>, mut entities: Query<(&Slide, &mut Playing)>) -> Result {
    block.0.fill(0.0);
    for (slide, mut playing) in &mut entities {
        let voice = playing.0.get();
        // After a motion that is out of range, the voice plays on for 100 ms and then stops.
        let _ = voice.set_motion(Motion::new(slide.speed_mm_s, slide.force_n));
        voice.render_add(&mut block.0, 1.0)?;
    }
    Ok(())
}

/// Drops the voice when the entity gets another texture or loses its texture.
fn drop_voice(discard: On<Discard<Surface>>, mut commands: Commands) {
    commands.entity(discard.entity).try_remove::<Playing>();
}

#[derive(TypePath)]
struct TextureLoader;

impl AssetLoader for TextureLoader {
    type Asset = HapticTexture;
    type Settings = ();
    type Error = BevyError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        _: &mut LoadContext<'_>,
    ) -> Result<HapticTexture> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        Ok(HapticTexture(Texture::from_bytes(&bytes)?))
    }

    fn extensions(&self) -> &[&str] {
        &["htex"]
    }
}

#[derive(TypePath)]
struct LibraryLoader;

impl AssetLoader for LibraryLoader {
    type Asset = HapticLibrary;
    type Settings = ();
    type Error = BevyError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<HapticLibrary> {
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let library = Library::open_source(bytes)?;
        let mut textures = Vec::new();
        for entry in library.entries() {
            let name = entry?.name;
            let texture = Texture::from_library(&library, &name)?;
            textures.push(context.add_labeled_asset(name, HapticTexture(texture)));
        }
        Ok(HapticLibrary(textures))
    }

    fn extensions(&self) -> &[&str] {
        &["htexlib"]
    }
}
