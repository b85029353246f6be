// A Unity component that plays a texture through an AudioSource. The output of the AudioSource
// drives an actuator or a loudspeaker.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using System.IO;
using System.Threading;
using UnityEngine;

namespace Htex
{
    /// <summary>
    /// Unity component that plays a texture through an AudioSource, at the speed and force that
    /// scripts set. It renders in the audio thread.
    /// </summary>
    [RequireComponent(typeof(AudioSource))]
    public sealed class HtexSource : MonoBehaviour
    {
        /// <summary>
        /// The texture to play. If it is null, the file that Asset names is played.
        /// </summary>
        public HtexTexture Texture;
        /// <summary>
        /// Path of a .htex file, relative to the folder StreamingAssets, for files that are not
        /// imported into the project. This does not work on Android, where StreamingAssets has no
        /// file paths.
        /// </summary>
        public string Asset = "texture.htex";
        /// <summary>
        /// Id or short name of the model whose representation plays. If it is empty, the
        /// representation with the smallest error plays.
        /// </summary>
        public string Model = "";
        /// <summary>Seed of the noise.</summary>
        public int Seed;
        /// <summary>
        /// Factor that converts samples in the asset's unit to fractions of full scale.
        /// </summary>
        public float Gain = 10.0f;
        /// <summary>Scanning speed, mm/s. Scripts may set it at any time.</summary>
        public float SpeedMmS;
        /// <summary>Normal force, N. Scripts may set it at any time.</summary>
        public float ForceN = 0.4f;

        private Asset asset;
        private volatile Voice voice;
        private float[] samples = new float[0];
        private volatile string failure;

        private void OnEnable()
        {
            failure = null;
            try
            {
                Open();
            }
            catch (HtexException error)
            {
                Fail(error.Message);
            }
            catch (DllNotFoundException error)
            {
                Fail("the library is not there; see Plugins in the documentation of the package: " + error.Message);
            }
            catch (PlatformNotSupportedException error)
            {
                Fail(error.Message);
            }
        }

        private void Open()
        {
#if UNITY_WEBGL && !UNITY_EDITOR
            throw new PlatformNotSupportedException("Unity Web has no audio thread for scripts; pages play textures with the npm package htex");
#else
            asset = Texture != null ? Texture.Open() : Htex.Asset.Open(Path.Combine(Application.streamingAssetsPath, Asset));
            voice = asset.Voice(new VoiceOptions
            {
                Model = string.IsNullOrEmpty(Model) ? null : Model,
                RateHz = AudioSettings.outputSampleRate,
                Seed = (ulong)Seed,
                Motion = new Motion(0.0, 0.0),
            });
#endif
        }

        private void Fail(string text)
        {
            OnDisable();
            Debug.LogError("htex: " + text);
            enabled = false;
        }

        /// <summary>
        /// Frees the voice. If the audio thread is rendering at this moment, the voice is freed
        /// when that call returns.
        /// </summary>
        private void OnDisable()
        {
            Voice playing = voice;
            voice = null;
            if (playing != null)
                playing.Dispose();
            if (asset != null)
                asset.Dispose();
            asset = null;
        }

        private void Update()
        {
            string text = failure;
            if (text == null)
                return;
            failure = null;
            Debug.LogError("htex: " + text);
        }

        /// <summary>
        /// Unity calls this in the audio thread. It allocates memory only when the block length
        /// changes and when it fails. Invalid speeds and forces count as 0.
        /// </summary>
        private void OnAudioFilterRead(float[] data, int channels)
        {
            Voice playing = voice;
            if (playing == null || failure != null)
                return;
            int frames = data.Length / channels;
            if (samples.Length != frames)
                samples = new float[frames];
            try
            {
                playing.SetMotion(new Motion(Valid(Volatile.Read(ref SpeedMmS)), Valid(Volatile.Read(ref ForceN))));
                playing.Render(samples);
            }
            catch (ObjectDisposedException)
            {
                // The component was disabled after this block began.
                return;
            }
            catch (Exception error)
            {
                failure = error.Message;
                return;
            }
            for (int frame = 0; frame < frames; frame++)
                for (int channel = 0; channel < channels; channel++)
                    data[frame * channels + channel] += Gain * samples[frame];
        }

        private static double Valid(float number)
        {
            return number >= 0.0f && number <= float.MaxValue ? number : 0.0;
        }
    }
}
