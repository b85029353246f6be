// Htex.cs: libhtex for C#, in one file. C# 7.3, .NET Standard 2.0, mono, Unity (Mono and IL2CPP).
//
// Assets, libraries, voices, scenes and devices are SafeHandles: Dispose frees them, or the garbage
// collector. If one thread disposes of an object while another thread's call uses it, the object is
// freed when that call returns. Later calls throw ObjectDisposedException. Calls that fail throw
// HtexException. Voice.Render, RenderAdd, SetMotion, SetGain and Envelope, Scene.Render and
// Scene.SetFinger allocate nothing unless they fail, so an audio thread may call them.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using System.Collections.Generic;
using System.IO;
using System.Runtime.InteropServices;
using System.Text;

#if !UNITY_5_3_OR_NEWER
namespace AOT
{
    /// <summary>
    /// Marks functions that native code calls. Ahead-of-time compilers find them by this
    /// attribute's name. Unity defines the attribute itself.
    /// </summary>
    [AttributeUsage(AttributeTargets.Method)]
    internal sealed class MonoPInvokeCallbackAttribute : Attribute
    {
        internal MonoPInvokeCallbackAttribute(Type type)
        {
        }
    }
}
#endif

namespace Htex
{
    /// <summary>Status of a call; see htex_status.</summary>
    public enum Status
    {
        Ok = 0,
        InvalidArgument = 1,
        BadHandle = 2,
        Busy = 3,
        Io = 4,
        InvalidAsset = 5,
        NoRepresentation = 6,
        NoModel = 7,
        Model = 8,
        InvalidMotion = 9,
        InvalidScene = 10,
        Unsupported = 11,
        Truncated = 12,
        Internal = 13,
        InvalidLibrary = 14,
        Absent = 15,
        Device = 16,
        NotSigned = 17,
    }

    /// <summary>The error of a call to libhtex.</summary>
    public sealed class HtexException : Exception
    {
        public Status Status { get; }

        internal HtexException(Status status, string text) : base(text)
        {
            Status = status;
        }
    }

    /// <summary>Motion of a finger over a texture at one moment.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Motion
    {
        internal uint Size;
        /// <summary>Scanning speed, mm/s; finite and not negative.</summary>
        public double SpeedMmS;
        /// <summary>Normal force, N; finite and not negative.</summary>
        public double ForceN;
        /// <summary>Position along the finger's path, mm; NaN if unknown.</summary>
        public double PositionMm;
        /// <summary>Place on the surface, mm; NaN if unknown.</summary>
        public double XMm, YMm;

        public Motion(
            double speedMmS, double forceN, double positionMm = double.NaN, double xMm = double.NaN, double yMm = double.NaN)
        {
            Size = Native.MotionSize;
            SpeedMmS = speedMmS;
            ForceN = forceN;
            PositionMm = positionMm;
            XMm = xMm;
            YMm = yMm;
        }
    }

    /// <summary>Position and motion of a finger over a scene.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Finger
    {
        internal uint Size;
        /// <summary>Scanning speed, mm/s; negative on the back stroke.</summary>
        public double SpeedMmS;
        /// <summary>Normal force, N; not negative.</summary>
        public double ForceN;
        /// <summary>Position, mm. If the position is unknown, set both to NaN.</summary>
        public double XMm, YMm;

        public Finger(double speedMmS, double forceN, double xMm = double.NaN, double yMm = double.NaN)
        {
            Size = Native.FingerSize;
            SpeedMmS = speedMmS;
            ForceN = forceN;
            XMm = xMm;
            YMm = yMm;
        }
    }

    /// <summary>
    /// A recorded condition: a speed and a normal force. NaN stands for an unknown value.
    /// </summary>
    [Serializable, StructLayout(LayoutKind.Sequential)]
    public struct Condition
    {
        public double SpeedMmS, ForceN;
    }

    /// <summary>A frequency band.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Band
    {
        public double LowHz, HighHz;
    }

    /// <summary>
    /// Level and mean frequency of what a voice played since the last call; see
    /// htex_voice_envelope.
    /// </summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Envelope
    {
        internal uint Size;
        /// <summary>RMS of the samples, in the asset's unit; 0 if there are none.</summary>
        public double LevelRms;
        /// <summary>Mean frequency of the spectrum, weighted by power, Hz; 0 for silence.</summary>
        public double CentroidHz;
        /// <summary>Number of samples since the last call.</summary>
        public ulong Frames;
    }

    /// <summary>The engine that runs WASM modules; see htex_open_options.</summary>
    public enum Engine
    {
        /// <summary>WASM modules are not loaded.</summary>
        Off = 0,
        /// <summary>WASM modules run without signal handlers.</summary>
        Checked = 1,
        /// <summary>
        /// WASM modules run with process-wide signal handlers. Some C# runtimes do not allow such
        /// handlers.
        /// </summary>
        Signals = 2,
    }

    /// <summary>Level of a message.</summary>
    public enum LogLevel
    {
        Info = 0,
        Warning = 1,
    }

    /// <summary>
    /// Options for making a voice. null and 0 select the defaults; see htex_voice_options.
    /// </summary>
    public sealed class VoiceOptions
    {
        public string Model;
        public double RateHz;
        public ulong Seed;
        public Motion? Motion;
        public string Synthesis;
        /// <summary>Gain of the samples; 0 selects a gain of 1.</summary>
        public double Gain;
        /// <summary>
        /// Largest absolute value of a sample after the gain, in the asset's unit; 0 for no limit.
        /// </summary>
        public double Limit;
        /// <summary>Number of bands of the envelope, 1 to 32; 0 for no envelope.</summary>
        public int EnvelopeBands;
        public bool FrequencyScaling = true, LevelScaling = true, Contact = true;
        /// <summary>
        /// Highest level that the voice reaches at motions outside the recorded conditions, as a
        /// multiple of the strongest recorded level; 0 selects 4.
        /// </summary>
        public double Ceiling;
        /// <summary>
        /// Whether the texture becomes stronger and weaker in time as its recording did, if the
        /// asset states how much.
        /// </summary>
        public bool Fluctuation;
    }

    /// <summary>Options for opening an asset or a scene; see htex_open_options.</summary>
    public sealed class OpenOptions
    {
        /// <summary>Paths of model files to load: native libraries or WASM modules.</summary>
        public string[] Plugins = new string[0];
        /// <summary>Models as WASM modules in memory. They run in a sandbox.</summary>
        public byte[][] Modules = new byte[0][];
        /// <summary>The engine that runs WASM modules.</summary>
        public Engine Engine = Engine.Off;
        /// <summary>Folder that keeps compiled WASM modules; null to keep none.</summary>
        public string Cache;
        /// <summary>
        /// Whether WASM modules that are embedded in assets run. They need an engine, and run in
        /// its sandbox.
        /// </summary>
        public bool Embedded = true;
        /// <summary>Whether installed models are loaded.</summary>
        public bool Installed;
        /// <summary>
        /// Public keys, each in 64 hexadecimal digits. If there are any, one of them must have
        /// signed each texture. The signature of a file is beside it, in PATH.sig.
        /// </summary>
        public string[] OnlySignedBy = new string[0];
        /// <summary>
        /// The contents of the file with the signature, for what has no path; null if there is
        /// none.
        /// </summary>
        public byte[] Signature;
    }

    /// <summary>
    /// A function of the program that reads `count` bytes of a file, starting at `offset`, into the
    /// start of `buffer`. It throws if it cannot read them. It must not call libhtex. If the file
    /// is a library of textures, several threads that open textures may call it at the same time.
    /// </summary>
    public delegate void ReadAt(long offset, byte[] buffer, int count);

    /// <summary>
    /// An open asset: a texture from a .htex file. Several threads may use it at the same time.
    /// </summary>
    public sealed class Asset : SafeHandle
    {
        internal Asset(ulong id) : base(IntPtr.Zero, true)
        {
            Native.Keep(this, id, SetHandle);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_asset_free(new Native.Handle { Id = (ulong)(long)handle }) == Status.Ok;
        }

        public static Asset Open(string path, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                Native.Handle asset;
                Native.Check(Native.htex_asset_open(Native.Utf8(path), ref open.Options, out asset));
                return new Asset(asset.Id);
            }
        }

        public static Asset FromBytes(byte[] bytes, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                Native.Handle asset;
                Native.Check(Native.htex_asset_from_bytes(bytes, Native.Length(bytes), ref open.Options, out asset));
                return new Asset(asset.Id);
            }
        }

        /// <summary>
        /// Opens an asset of `length` bytes through the function `read`. The function is not called
        /// after this returns.
        /// </summary>
        public static Asset FromReader(long length, ReadAt read, OpenOptions options = null)
        {
            return FromReader(new FileReader(length, read, null), options);
        }

        /// <summary>
        /// Opens an asset from a stream. The asset must begin at the start of the stream. The
        /// stream must be able to seek, and stays open.
        /// </summary>
        public static Asset FromStream(Stream stream, OpenOptions options = null)
        {
            return FromReader(FileReader.Of(stream, true), options);
        }

        private static Asset FromReader(FileReader reader, OpenOptions options)
        {
            using (var open = new Native.Open(options))
            {
                var file = reader.Held();
                Native.Handle asset;
                Native.Check(Native.htex_asset_open_reader(ref file, ref open.Options, out asset));
                return new Asset(asset.Id);
            }
        }

        public string Name
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_name(this, o, c, out l)); }
        }

        /// <summary>The frequency band of the asset's spectra.</summary>
        public Band Band
        {
            get
            {
                Band band;
                Native.Check(Native.htex_asset_band(this, out band));
                return band;
            }
        }

        /// <summary>
        /// Returns the level at which a representation plays: RMS, in the asset's unit.
        /// </summary>
        public double LevelRms(string model = null, Motion? at = null)
        {
            double level;
            Native.Check(Native.htex_asset_level_rms(this, Native.Utf8(model), Native.Sized(at), out level));
            return level;
        }

        /// <summary>The manifest as JSON.</summary>
        public string ManifestJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_manifest_json(this, o, c, out l)); }
        }

        /// <summary>Unit of the samples.</summary>
        public string Unit
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_unit(this, o, c, out l)); }
        }

        /// <summary>The model id of each representation.</summary>
        public string[] Models
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_asset_representation_count(this, out count));
                var models = new string[(int)count];
                for (int i = 0; i < models.Length; i++)
                {
                    var index = (UIntPtr)i;
                    models[i] = Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_representation_model(this, index, o, c, out l));
                }
                return models;
            }
        }

        /// <summary>The recorded conditions.</summary>
        public Condition[] Conditions
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_asset_condition_count(this, out count));
                var conditions = new Condition[(int)count];
                for (int i = 0; i < conditions.Length; i++)
                    Native.Check(Native.htex_asset_condition(this, (UIntPtr)i, out conditions[i]));
                return conditions;
            }
        }

        /// <summary>
        /// Returns the spectrum that a recording of the voice would show: one magnitude, in the
        /// asset's unit, for each frequency in Hz.
        /// </summary>
        public double[] Magnitude(double[] frequencyHz, string model = null, Motion? at = null)
        {
            var magnitude = new double[frequencyHz.Length];
            Native.Check(Native.htex_asset_magnitude(this, Native.Utf8(model), Native.Sized(at), frequencyHz, magnitude, Native.Length(magnitude)));
            return magnitude;
        }

        /// <summary>Makes a voice, which plays the asset.</summary>
        public Voice Voice(VoiceOptions options = null)
        {
            return new Voice(this, options ?? new VoiceOptions());
        }
    }

    /// <summary>
    /// An open library: a .htexlib file with any number of textures. Several threads may use it at
    /// the same time.
    /// </summary>
    public sealed class Library : SafeHandle
    {
        private Library(ulong id) : base(IntPtr.Zero, true)
        {
            Native.Keep(this, id, SetHandle);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_library_free(new Native.Handle { Id = (ulong)(long)handle }) == Status.Ok;
        }

        public static Library Open(string path)
        {
            Native.Handle library;
            Native.Check(Native.htex_library_open(Native.Utf8(path), out library));
            return new Library(library.Id);
        }

        /// <summary>Opens a library in memory.</summary>
        public static Library FromBytes(byte[] bytes)
        {
            Native.Handle library;
            Native.Check(Native.htex_library_from_bytes(bytes, Native.Length(bytes), out library));
            return new Library(library.Id);
        }

        /// <summary>
        /// Opens a library of `length` bytes through the function `read`, which is called until the
        /// library is freed. Then `close` is called. It is also called if opening fails.
        /// </summary>
        public static Library FromReader(long length, ReadAt read, Action close = null)
        {
            return FromReader(new FileReader(length, read, close));
        }

        /// <summary>
        /// Opens a library from a stream. The library must begin at the start of the stream, and
        /// the stream must be able to seek. The stream is disposed of when the library is freed.
        /// </summary>
        public static Library FromStream(Stream stream)
        {
            return FromReader(FileReader.Of(stream, false));
        }

        private static Library FromReader(FileReader reader)
        {
            var file = reader.Held();
            Native.Handle library;
            Native.Check(Native.htex_library_open_reader(ref file, out library));
            return new Library(library.Id);
        }

        /// <summary>
        /// Opens a texture of the library as an asset. Reads only the parts of the file that it
        /// needs.
        /// </summary>
        public Asset Asset(string name, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                Native.Handle asset;
                Native.Check(Native.htex_library_asset(this, Native.Utf8(name), ref open.Options, out asset));
                return new Asset(asset.Id);
            }
        }

        public string Name
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_name(this, o, c, out l)); }
        }

        /// <summary>Number of textures in the library.</summary>
        public ulong Count
        {
            get
            {
                ulong count;
                Native.Check(Native.htex_library_count(this, out count));
                return count;
            }
        }

        /// <summary>
        /// Number of pages in the library's index. Each page lists some of the textures.
        /// </summary>
        public int PageCount
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_library_page_count(this, out count));
                return (int)count;
            }
        }

        /// <summary>
        /// Returns the entries of an index page as a JSON array; see htex_library_page_json.
        /// </summary>
        public string PageJson(int page)
        {
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_page_json(this, (UIntPtr)page, o, c, out l));
        }

        /// <summary>Returns the index entry of a texture as JSON.</summary>
        public string EntryJson(string name)
        {
            var text = Native.Utf8(name);
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_entry_json(this, text, o, c, out l));
        }
    }

    /// <summary>A texture that is playing. Only one thread at a time may use it.</summary>
    public sealed class Voice : SafeHandle
    {
        internal Voice(Asset asset, VoiceOptions options) : base(IntPtr.Zero, true)
        {
            var model = Native.Pin(Native.Utf8(options.Model));
            var synthesis = Native.Pin(Native.Utf8(options.Synthesis));
            var motion = Native.Pin(Native.Sized(options.Motion));
            try
            {
                var c = new Native.VoiceOptions
                {
                    Size = (uint)Marshal.SizeOf(typeof(Native.VoiceOptions)),
                    Model = Native.Address(model),
                    RateHz = options.RateHz,
                    Seed = options.Seed,
                    Motion = Native.Address(motion),
                    Synthesis = Native.Address(synthesis),
                    Gain = options.Gain,
                    Limit = options.Limit,
                    EnvelopeBands = (uint)options.EnvelopeBands,
                    NoFrequencyScaling = options.FrequencyScaling ? 0u : 1u,
                    NoLevelScaling = options.LevelScaling ? 0u : 1u,
                    NoContact = options.Contact ? 0u : 1u,
                    Ceiling = options.Ceiling,
                    Fluctuation = options.Fluctuation ? 1u : 0u,
                };
                Native.Handle voice;
                Native.Check(Native.htex_voice_new(asset, ref c, out voice));
                Native.Keep(this, voice.Id, SetHandle);
            }
            finally
            {
                Native.Unpin(model);
                Native.Unpin(synthesis);
                Native.Unpin(motion);
            }
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_voice_free(new Native.Handle { Id = (ulong)(long)handle }) == Status.Ok;
        }

        /// <summary>
        /// The voice's handle in libhtex. After the voice is disposed of, calls with this handle
        /// return an error.
        /// </summary>
        internal ulong Id { get { return (ulong)(long)handle; } }

        /// <summary>
        /// Sets the motion of the finger. Spectrum and level change gradually to the new motion.
        /// </summary>
        public void SetMotion(Motion motion)
        {
            motion.Size = Native.MotionSize;
            Native.Check(Native.htex_voice_set_motion(this, ref motion));
        }

        /// <summary>Renders the next samples, in the asset's unit.</summary>
        public void Render(float[] samples)
        {
            Render(samples, 0, samples.Length);
        }

        /// <summary>Renders the next samples into a part of an array.</summary>
        public void Render(float[] samples, int offset, int count)
        {
            Native.CheckPart(samples, offset, count);
            // Passing a reference is twice as fast as passing an array. An empty array has no
            // element to refer to.
            if (count > 0)
                Native.Check(Native.htex_voice_render(this, ref samples[offset], (UIntPtr)count));
            else
                Native.Check(Native.htex_voice_render(this, ref Native.None, UIntPtr.Zero));
        }

        /// <summary>
        /// Renders the next samples into memory. HtexNativeArray.cs does the same for Unity's
        /// NativeArray.
        /// </summary>
        public void Render(IntPtr samples, int count)
        {
            Native.Check(Native.htex_voice_render_to(this, samples, Native.Count(count)));
        }

        /// <summary>
        /// Renders the next samples, multiplies them by a gain and adds them to a part of an array.
        /// </summary>
        public void RenderAdd(float[] samples, int offset, int count, float gain = 1.0f)
        {
            Native.CheckPart(samples, offset, count);
            if (count > 0)
                Native.Check(Native.htex_voice_render_add(this, ref samples[offset], (UIntPtr)count, gain));
        }

        /// <summary>
        /// Renders the next samples, multiplies them by a gain and adds them to memory.
        /// </summary>
        public void RenderAdd(IntPtr samples, int count, float gain = 1.0f)
        {
            Native.Check(Native.htex_voice_render_add_to(this, samples, Native.Count(count), gain));
        }

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP || UNITY_2021_2_OR_NEWER
        /// <summary>Renders the next samples into a span.</summary>
        public void Render(Span<float> samples)
        {
            Native.Check(Native.htex_voice_render(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length));
        }

        /// <summary>
        /// Renders the next samples, multiplies them by a gain and adds them to a span.
        /// </summary>
        public void RenderAdd(Span<float> samples, float gain = 1.0f)
        {
            Native.Check(Native.htex_voice_render_add(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length, gain));
        }
#endif

        /// <summary>Sets the gain. The voice reaches the new gain within 10 ms.</summary>
        public void SetGain(double gain)
        {
            Native.Check(Native.htex_voice_set_gain(this, gain));
        }

        /// <summary>
        /// Whether the voice is silent: its samples are 0 until the finger slides again.
        /// </summary>
        public bool IsSilent
        {
            get
            {
                uint silent;
                Native.Check(Native.htex_voice_is_silent(this, out silent));
                return silent != 0;
            }
        }

        /// <summary>
        /// Returns the level and mean frequency of what was rendered since the last call. `bands`
        /// receives the mean square of the samples in each band. It must have one element per band,
        /// or be null.
        /// </summary>
        public Envelope Envelope(double[] bands = null)
        {
            var envelope = new Envelope { Size = Native.EnvelopeSize };
            if (bands == null || bands.Length == 0)
                Native.Check(Native.htex_voice_envelope(this, ref envelope, ref Native.NoBand, UIntPtr.Zero));
            else
                Native.Check(Native.htex_voice_envelope(this, ref envelope, ref bands[0], (UIntPtr)bands.Length));
            return envelope;
        }

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP || UNITY_2021_2_OR_NEWER
        /// <summary>Does the same as Envelope with an array, for a span.</summary>
        public Envelope Envelope(Span<double> bands)
        {
            var envelope = new Envelope { Size = Native.EnvelopeSize };
            Native.Check(Native.htex_voice_envelope(this, ref envelope, ref MemoryMarshal.GetReference(bands), (UIntPtr)bands.Length));
            return envelope;
        }
#endif

        /// <summary>
        /// Returns the edges of the envelope's bands, Hz: one more than `bands`, which must be the
        /// voice's number of bands.
        /// </summary>
        public double[] EnvelopeEdges(int bands)
        {
            var edges = new double[bands + 1];
            Native.Check(Native.htex_voice_envelope_edges(this, edges, Native.Length(edges)));
            return edges;
        }

        /// <summary>
        /// Restarts the voice with the same options, at `motion`, or at the motion in its options
        /// if `motion` is null. Do not call this in an audio thread.
        /// </summary>
        public void Reset(Motion? motion = null)
        {
            Native.Check(Native.htex_voice_reset(this, Native.Sized(motion)));
        }

        /// <summary>The id of the model that plays.</summary>
        public string Model
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_voice_model(this, o, c, out l)); }
        }

        /// <summary>Renders a block of `frames` samples for each motion.</summary>
        public void RenderPath(Motion[] motions, float[] samples, int frames)
        {
            if ((long)motions.Length * frames != samples.Length)
                throw new ArgumentException("samples has not one block of `frames` for each motion", "samples");
            for (int i = 0; i < motions.Length; i++)
                motions[i].Size = Native.MotionSize;
            Native.Check(Native.htex_voice_render_path(this, motions, Native.Length(motions), samples, (UIntPtr)frames));
        }

        /// <summary>
        /// Returns an English text that states how the voice plays a motion, and whether the motion
        /// lies within the recorded conditions.
        /// </summary>
        public string Coverage(Motion motion)
        {
            motion.Size = Native.MotionSize;
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_voice_coverage(this, ref motion, o, c, out l));
        }
    }

    /// <summary>
    /// A scene that plays: surfaces, a finger's motion over them, and the samples that result. Only
    /// one thread at a time may use it.
    /// </summary>
    public sealed class Scene : SafeHandle
    {
        private Scene(ulong id) : base(IntPtr.Zero, true)
        {
            Native.Keep(this, id, SetHandle);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_scene_free(new Native.Handle { Id = (ulong)(long)handle }) == Status.Ok;
        }

        public static Scene Open(string path, double rateHz = 0, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                var c = new Native.SceneOptions { Size = (uint)Marshal.SizeOf(typeof(Native.SceneOptions)), RateHz = rateHz };
                Native.Handle scene;
                Native.Check(Native.htex_scene_open(Native.Utf8(path), ref open.Options, ref c, out scene));
                return new Scene(scene.Id);
            }
        }

        /// <summary>
        /// Opens a scene file in memory. `files` returns the contents of each file that the scene
        /// names, or null if there is no such file.
        /// </summary>
        public static Scene FromBytes(byte[] bytes, Func<string, byte[]> files, double rateHz = 0, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            using (var given = new SceneFiles(files))
            {
                var c = new Native.SceneOptions { Size = (uint)Marshal.SizeOf(typeof(Native.SceneOptions)), RateHz = rateHz };
                var f = given.Files;
                Native.Handle scene;
                Native.Check(Native.htex_scene_from_bytes(bytes, Native.Length(bytes), ref f, ref open.Options, ref c, out scene));
                return new Scene(scene.Id);
            }
        }

        /// <summary>The scene's plan as JSON; see htex_scene_plan_json.</summary>
        public string PlanJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_scene_plan_json(this, o, c, out l)); }
        }

        /// <summary>Sample rate, Hz.</summary>
        public double RateHz
        {
            get
            {
                double rate;
                Native.Check(Native.htex_scene_rate_hz(this, out rate));
                return rate;
            }
        }

        /// <summary>
        /// Sets the position and motion of the finger. This has an effect only in scenes with live
        /// motion.
        /// </summary>
        public void SetFinger(Finger finger)
        {
            finger.Size = Native.FingerSize;
            Native.Check(Native.htex_scene_set_finger(this, ref finger));
        }

        /// <summary>
        /// Renders the next samples and returns their number. At the end of the scene, the number
        /// is smaller than the array's length.
        /// </summary>
        public int Render(float[] samples)
        {
            return Render(samples, 0, samples.Length);
        }

        /// <summary>
        /// Renders the next samples into a part of an array and returns their number.
        /// </summary>
        public int Render(float[] samples, int offset, int count)
        {
            Native.CheckPart(samples, offset, count);
            UIntPtr rendered;
            if (count > 0)
                Native.Check(Native.htex_scene_render(this, ref samples[offset], (UIntPtr)count, out rendered));
            else
                Native.Check(Native.htex_scene_render(this, ref Native.None, UIntPtr.Zero, out rendered));
            return (int)rendered;
        }

        /// <summary>Renders the next samples into memory and returns their number.</summary>
        public int Render(IntPtr samples, int count)
        {
            UIntPtr rendered;
            Native.Check(Native.htex_scene_render_to(this, samples, Native.Count(count), out rendered));
            return (int)rendered;
        }

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP || UNITY_2021_2_OR_NEWER
        /// <summary>Renders the next samples into a span and returns their number.</summary>
        public int Render(Span<float> samples)
        {
            UIntPtr rendered;
            Native.Check(Native.htex_scene_render(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length, out rendered));
            return (int)rendered;
        }
#endif

        /// <summary>
        /// Makes the scene end as soon as possible: the next samples fade to silence.
        /// </summary>
        public void Stop()
        {
            Native.Check(Native.htex_scene_stop(this));
        }
    }

    /// <summary>
    /// An open device, which plays samples. Only one thread at a time may use it. If it is disposed
    /// of before Finish was called, it goes to rest at once.
    /// </summary>
    public sealed class Device : SafeHandle
    {
        private Device(ulong id) : base(IntPtr.Zero, true)
        {
            Native.Keep(this, id, SetHandle);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_device_free(new Native.Handle { Id = (ulong)(long)handle }) == Status.Ok;
        }

        /// <summary>
        /// The kinds of devices that the library can play on, as JSON; see htex_device_list_json.
        /// </summary>
        public static string ListJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_device_list_json(o, c, out l)); }
        }

        /// <summary>
        /// Returns a description of a device as JSON: its settings, the quantity of its samples,
        /// its sample rates; see htex_device_info_json.
        /// </summary>
        public static string InfoJson(string name, string settings = "")
        {
            byte[] n = Native.Utf8(name), s = Native.Utf8(settings);
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_device_info_json(n, s, o, c, out l));
        }

        /// <summary>
        /// Opens a device by its name, such as sdl. `settings` holds lines of the form NAME=VALUE.
        /// A `rateHz` of 0 selects the device's own sample rate.
        /// </summary>
        public static Device Open(string name, string settings = "", double rateHz = 0)
        {
            Native.Handle device;
            Native.Check(Native.htex_device_open(Native.Utf8(name), Native.Utf8(settings), rateHz, out device));
            return new Device(device.Id);
        }

        /// <summary>Sample rate, Hz.</summary>
        public double RateHz
        {
            get
            {
                double rate;
                Native.Check(Native.htex_device_rate_hz(this, out rate));
                return rate;
            }
        }

        /// <summary>
        /// Passes samples to the device, as many as it takes within `timeoutMs`, and returns their
        /// number.
        /// </summary>
        public int Write(float[] samples, int offset, int count, int timeoutMs = 1000)
        {
            Native.CheckPart(samples, offset, count);
            UIntPtr written = UIntPtr.Zero;
            if (count > 0)
                Native.Check(Native.htex_device_write(this, ref samples[offset], (UIntPtr)count, (uint)Math.Max(timeoutMs, 0), out written));
            return (int)written;
        }

        /// <summary>How many samples the device has played, and its other counts.</summary>
        public DeviceCounts Counts
        {
            get
            {
                var counts = new DeviceCounts { Size = (uint)Marshal.SizeOf(typeof(DeviceCounts)) };
                Native.Check(Native.htex_device_status(this, ref counts));
                return counts;
            }
        }

        /// <summary>
        /// Plays all samples that were written, then brings the device to rest; see
        /// htex_device_finish.
        /// </summary>
        public void Finish()
        {
            Native.Check(Native.htex_device_finish(this));
        }
    }

    /// <summary>What a device has done since it was opened; see htex_device_counts.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct DeviceCounts
    {
        internal uint Size;
        /// <summary>Number of samples written to the device.</summary>
        public ulong FramesWritten;
        /// <summary>Number of samples played.</summary>
        public ulong FramesPlayed;
        /// <summary>Number of times that the device ran out of samples.</summary>
        public ulong Underruns;
        /// <summary>Time from writing a sample to its output, s.</summary>
        public double LatencyS;
        /// <summary>Largest absolute value written, in the device's unit.</summary>
        public double Peak;
    }

    /// <summary>Functions of the library as a whole: its version, messages and shutdown.</summary>
    public static class LibHtex
    {
        private static readonly Native.Log Passing = Pass;
        private static volatile Action<LogLevel, string> receiver;

        static LibHtex()
        {
            // Unity's editor unloads this code when scripts change, but libhtex stays loaded. It
            // must not call a function that was unloaded.
            AppDomain.CurrentDomain.DomainUnload += (sender, unloaded) => Forget();
        }

        private static void Forget()
        {
            if (receiver != null)
                SetLog(null);
        }

        /// <summary>Version of the library.</summary>
        public static string Version { get { return Native.FromUtf8(Native.htex_version()); } }

        /// <summary>Returns the meaning of a status, in English.</summary>
        public static string Text(Status status)
        {
            return Native.FromUtf8(Native.htex_status_text(status));
        }

        /// <summary>
        /// Sets the function that receives messages; null for none. The function must not call
        /// libhtex.
        /// </summary>
        public static void SetLog(Action<LogLevel, string> log)
        {
            receiver = log;
            Native.Check(Native.htex_set_log(log == null ? null : Passing, IntPtr.Zero));
        }

        /// <summary>
        /// Frees everything that the library holds. No other call may run at the same time.
        /// Remaining objects can no longer be used.
        /// </summary>
        public static void Shutdown()
        {
            Native.Check(Native.htex_shutdown());
        }

        [AOT.MonoPInvokeCallback(typeof(Native.Log))]
        private static void Pass(LogLevel level, IntPtr message, IntPtr context)
        {
            var log = receiver;
            try
            {
                if (log != null)
                    log(level, Native.FromUtf8(message));
            }
            catch (Exception)
            {
                // Exceptions must not pass through libhtex, so this one is dropped.
            }
        }
    }

    /// <summary>
    /// A file that libhtex reads through a function of the program. The object stays alive until
    /// the library closes the file.
    /// </summary>
    internal sealed class FileReader
    {
        private static readonly Native.ReadFile Reading = Read;
        private static readonly Native.CloseFile Closing = Close;
        private readonly long length;
        private readonly ReadAt read;
        private readonly Action close;

        internal FileReader(long length, ReadAt read, Action close)
        {
            if (length < 0)
                throw new ArgumentOutOfRangeException("length", "negative");
            if (read == null)
                throw new ArgumentNullException("read");
            this.length = length;
            this.read = read;
            this.close = close;
        }

        internal static FileReader Of(Stream stream, bool leaveOpen)
        {
            if (!stream.CanSeek || !stream.CanRead)
                throw new ArgumentException("the stream cannot be read or cannot seek; copy it to a MemoryStream", "stream");
            return new FileReader(stream.Length, (offset, buffer, count) => Fill(stream, offset, buffer, count), leaveOpen ? null : (Action)stream.Dispose);
        }

        private static void Fill(Stream stream, long offset, byte[] buffer, int count)
        {
            // A stream has one position, which all threads share.
            lock (stream)
            {
                stream.Position = offset;
                for (int done = 0; done < count;)
                {
                    int got = stream.Read(buffer, done, count - done);
                    if (got == 0)
                        throw new EndOfStreamException();
                    done += got;
                }
            }
        }

        /// <summary>
        /// Returns the struct for the library, and keeps this object alive until the library closes
        /// the file, which it does once.
        /// </summary>
        internal Native.ReaderC Held()
        {
            return new Native.ReaderC
            {
                Size = (uint)Marshal.SizeOf(typeof(Native.ReaderC)),
                Length = (ulong)length,
                Context = GCHandle.ToIntPtr(GCHandle.Alloc(this)),
                Read = Native.Function(Reading),
                Close = Native.Function(Closing),
            };
        }

        [AOT.MonoPInvokeCallback(typeof(Native.ReadFile))]
        private static int Read(IntPtr context, ulong offset, IntPtr buffer, UIntPtr length)
        {
            try
            {
                var bytes = new byte[(int)length];
                ((FileReader)GCHandle.FromIntPtr(context).Target).read((long)offset, bytes, bytes.Length);
                Marshal.Copy(bytes, 0, buffer, bytes.Length);
                return 0;
            }
            catch (Exception)
            {
                // Exceptions must not pass through libhtex. It treats the file as unreadable.
                return 1;
            }
        }

        [AOT.MonoPInvokeCallback(typeof(Native.CloseFile))]
        private static void Close(IntPtr context)
        {
            var held = GCHandle.FromIntPtr(context);
            var close = ((FileReader)held.Target).close;
            held.Free();
            try
            {
                if (close != null)
                    close();
            }
            catch (Exception)
            {
                // This exception must not pass through libhtex either. The file is not read any
                // more.
            }
        }
    }

    /// <summary>The files of a scene, which a function of the program returns.</summary>
    internal sealed class SceneFiles : IDisposable
    {
        private static readonly Native.OpenFile Opening = Open;
        private readonly Func<string, byte[]> files;
        private GCHandle self;

        internal SceneFiles(Func<string, byte[]> files)
        {
            this.files = files;
            self = GCHandle.Alloc(this);
        }

        internal Native.FilesC Files
        {
            get
            {
                return new Native.FilesC
                {
                    Size = (uint)Marshal.SizeOf(typeof(Native.FilesC)),
                    Context = GCHandle.ToIntPtr(self),
                    Open = Native.Function(Opening),
                };
            }
        }

        public void Dispose()
        {
            self.Free();
        }

        [AOT.MonoPInvokeCallback(typeof(Native.OpenFile))]
        private static int Open(IntPtr context, IntPtr name, ref Native.ReaderC file)
        {
            byte[] bytes;
            try
            {
                bytes = ((SceneFiles)GCHandle.FromIntPtr(context).Target).files(Native.FromUtf8(name));
            }
            catch (Exception)
            {
                // Exceptions must not pass through libhtex. It treats the file as missing.
                bytes = null;
            }
            if (bytes == null)
                return 1;
            file = new FileReader(bytes.Length, (offset, buffer, count) => Array.Copy(bytes, offset, buffer, 0, count), null).Held();
            return 0;
        }
    }

    /// <summary>
    /// The functions of htex.h. Each call keeps the objects that are passed to it alive.
    /// </summary>
    internal static class Native
    {
#if UNITY_IOS && !UNITY_EDITOR
        internal const string Library = "__Internal";
#else
        internal const string Library = "htex";
#endif

        /// <summary>The address that is passed for an empty array; never written.</summary>
        internal static float None;
        internal static double NoBand;

        internal static readonly uint MotionSize = (uint)Marshal.SizeOf(typeof(Motion));
        internal static readonly uint FingerSize = (uint)Marshal.SizeOf(typeof(Finger));
        internal static readonly uint EnvelopeSize = (uint)Marshal.SizeOf(typeof(Envelope));

        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        internal delegate void Log(LogLevel level, IntPtr message, IntPtr context);

        /// <summary>
        /// Returns an array with one motion whose size field is set, or null for no motion.
        /// </summary>
        internal static Motion[] Sized(Motion? motion)
        {
            if (!motion.HasValue)
                return null;
            var motions = new[] { motion.Value };
            motions[0].Size = MotionSize;
            return motions;
        }

        /// <summary>
        /// Returns the address of a static function. The delegate must live as long as native code
        /// uses the address. The parameter is a plain Delegate, because an ahead-of-time compiler
        /// could miss generic code.
        /// </summary>
        internal static IntPtr Function(Delegate function)
        {
            return Marshal.GetFunctionPointerForDelegate(function);
        }

        internal static void CheckPart(float[] samples, int offset, int count)
        {
            if (offset < 0 || count < 0 || offset > samples.Length - count)
                throw new ArgumentOutOfRangeException("count", "the part is not in the array");
        }

        internal static UIntPtr Count(int count)
        {
            if (count < 0)
                throw new ArgumentOutOfRangeException("count", "negative");
            return (UIntPtr)count;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct Handle
        {
            internal ulong Id;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct OpenOptionsC
        {
            internal uint Size, Engine;
            internal IntPtr Plugins;
            internal UIntPtr PluginsLen;
            internal IntPtr Modules;
            internal UIntPtr ModulesLen;
            internal IntPtr Cache;
            internal uint NoEmbedded, Installed;
            internal IntPtr OnlySignedBy;
            internal UIntPtr OnlySignedByLen;
            internal Bytes Signature;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct FilesC
        {
            internal uint Size;
            internal IntPtr Context, Open;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct ReaderC
        {
            internal uint Size;
            internal ulong Length;
            internal IntPtr Context, Read, Close;
        }

        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        internal delegate int OpenFile(IntPtr context, IntPtr name, ref ReaderC file);
        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        internal delegate int ReadFile(IntPtr context, ulong offset, IntPtr buffer, UIntPtr length);
        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        internal delegate void CloseFile(IntPtr context);

        [StructLayout(LayoutKind.Sequential)]
        internal struct Bytes
        {
            internal IntPtr Data;
            internal UIntPtr Len;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct VoiceOptions
        {
            internal uint Size;
            internal IntPtr Model;
            internal double RateHz;
            internal ulong Seed;
            internal IntPtr Motion, Synthesis;
            internal double Gain, Limit;
            internal uint EnvelopeBands;
            internal uint NoFrequencyScaling, NoLevelScaling, NoContact;
            internal double Ceiling;
            internal uint Fluctuation;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct SceneOptions
        {
            internal uint Size;
            internal double RateHz;
        }

        /// <summary>
        /// Options for opening, in their C form. The memory that they point to stays in place until
        /// this object is disposed of.
        /// </summary>
        internal sealed class Open : IDisposable
        {
            internal OpenOptionsC Options;
            private readonly List<GCHandle> pinned = new List<GCHandle>();

            internal Open(OpenOptions options)
            {
                options = options ?? new OpenOptions();
                var plugins = Array.ConvertAll(options.Plugins, plugin => Keep(Utf8(plugin)));
                var keys = Array.ConvertAll(options.OnlySignedBy, key => Keep(Utf8(key)));
                var modules = Array.ConvertAll(options.Modules, module => new Bytes { Data = Keep(module), Len = Length(module) });
                Options = new OpenOptionsC
                {
                    Size = (uint)Marshal.SizeOf(typeof(OpenOptionsC)),
                    Engine = (uint)options.Engine,
                    Cache = Keep(Utf8(options.Cache)),
                    Plugins = Keep(plugins),
                    PluginsLen = Length(plugins),
                    NoEmbedded = options.Embedded ? 0u : 1u,
                    Installed = options.Installed ? 1u : 0u,
                    Modules = Keep(modules),
                    ModulesLen = Length(modules),
                    OnlySignedBy = Keep(keys),
                    OnlySignedByLen = Length(keys),
                    Signature = new Bytes { Data = Keep(options.Signature), Len = Length(options.Signature) },
                };
            }

            private IntPtr Keep(object value)
            {
                pinned.Add(Pin(value));
                return Address(pinned[pinned.Count - 1]);
            }

            public void Dispose()
            {
                pinned.ForEach(Unpin);
            }
        }

        internal static void Keep(SafeHandle owner, ulong id, Action<IntPtr> set)
        {
            if (IntPtr.Size < 8)
                throw new PlatformNotSupportedException("handles of libhtex have 64 bits; run a 64-bit process");
            set((IntPtr)(long)id);
        }

        internal static void Check(Status status)
        {
            if (status != Status.Ok)
                throw new HtexException(status, FromUtf8(htex_last_error()));
        }

        internal static UIntPtr Length(Array array)
        {
            return (UIntPtr)(array == null ? 0 : array.Length);
        }

        internal static byte[] Utf8(string text)
        {
            return text == null ? null : Encoding.UTF8.GetBytes(text + "\0");
        }

        internal static string FromUtf8(IntPtr text)
        {
            int length = 0;
            while (Marshal.ReadByte(text, length) != 0)
                length++;
            var bytes = new byte[length];
            Marshal.Copy(text, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        internal delegate Status Writer(byte[] text, UIntPtr capacity, out UIntPtr length);

        internal static string Text(Writer write)
        {
            UIntPtr length;
            Check(write(null, UIntPtr.Zero, out length));
            var bytes = new byte[(int)length + 1];
            Check(write(bytes, Length(bytes), out length));
            return Encoding.UTF8.GetString(bytes, 0, (int)length);
        }

        internal static GCHandle Pin(object value)
        {
            return value == null ? default(GCHandle) : GCHandle.Alloc(value, GCHandleType.Pinned);
        }

        internal static IntPtr Address(GCHandle pinned)
        {
            return pinned.IsAllocated ? pinned.AddrOfPinnedObject() : IntPtr.Zero;
        }

        internal static void Unpin(GCHandle pinned)
        {
            if (pinned.IsAllocated)
                pinned.Free();
        }

        [DllImport(Library)] internal static extern IntPtr htex_last_error();
        [DllImport(Library)] internal static extern IntPtr htex_version();
        [DllImport(Library)] internal static extern IntPtr htex_status_text(Status status);
        [DllImport(Library)] internal static extern Status htex_set_log(Log callback, IntPtr context);
        [DllImport(Library)] internal static extern Status htex_shutdown();
        [DllImport(Library)] internal static extern Status htex_asset_name(Asset asset, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_band(Asset asset, out Band band);
        [DllImport(Library)] internal static extern Status htex_asset_level_rms(Asset asset, byte[] model, Motion[] at, out double level);
        [DllImport(Library)] internal static extern Status htex_library_from_bytes(byte[] bytes, UIntPtr length, out Handle library);
        [DllImport(Library)] internal static extern Status htex_asset_open(byte[] path, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_from_bytes(byte[] bytes, UIntPtr length, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_open_reader(ref ReaderC reader, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_library_open_reader(ref ReaderC reader, out Handle library);
        [DllImport(Library)] internal static extern Status htex_asset_free(Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_manifest_json(Asset asset, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_unit(Asset asset, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_condition_count(Asset asset, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_asset_condition(Asset asset, UIntPtr index, out Condition condition);
        [DllImport(Library)] internal static extern Status htex_asset_representation_count(Asset asset, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_asset_representation_model(Asset asset, UIntPtr index, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_magnitude(Asset asset, byte[] model, Motion[] at, double[] frequencyHz, [Out] double[] magnitude, UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_open(byte[] path, out Handle library);
        [DllImport(Library)] internal static extern Status htex_library_free(Handle library);
        [DllImport(Library)] internal static extern Status htex_library_name(global::Htex.Library library, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_count(global::Htex.Library library, out ulong count);
        [DllImport(Library)] internal static extern Status htex_library_page_count(global::Htex.Library library, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_library_page_json(global::Htex.Library library, UIntPtr page, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_entry_json(global::Htex.Library library, byte[] name, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_asset(global::Htex.Library library, byte[] name, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_voice_new(Asset asset, ref VoiceOptions options, out Handle voice);
        [DllImport(Library)] internal static extern Status htex_voice_free(Handle voice);
        [DllImport(Library)] internal static extern Status htex_voice_set_motion(Voice voice, ref Motion motion);
        [DllImport(Library)] internal static extern Status htex_voice_render(Voice voice, ref float samples, UIntPtr frames);
        [DllImport(Library, EntryPoint = "htex_voice_render")] internal static extern Status htex_voice_render_to(Voice voice, IntPtr samples, UIntPtr frames);
        [DllImport(Library)] internal static extern Status htex_voice_render_add(Voice voice, ref float samples, UIntPtr frames, float gain);
        [DllImport(Library, EntryPoint = "htex_voice_render_add")] internal static extern Status htex_voice_render_add_to(Voice voice, IntPtr samples, UIntPtr frames, float gain);
        [DllImport(Library)] internal static extern Status htex_voice_set_gain(Voice voice, double gain);
        [DllImport(Library)] internal static extern Status htex_voice_is_silent(Voice voice, out uint silent);
        [DllImport(Library)] internal static extern Status htex_voice_envelope(Voice voice, ref Envelope envelope, ref double bands, UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_voice_envelope_edges(Voice voice, [Out] double[] edges, UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_voice_reset(Voice voice, Motion[] motion);
        [DllImport(Library)] internal static extern Status htex_voice_model(Voice voice, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_voice_render_path(Voice voice, Motion[] motions, UIntPtr motionsLength, [Out] float[] samples, UIntPtr frames);
        [DllImport(Library)] internal static extern Status htex_voice_coverage(Voice voice, ref Motion motion, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_device_list_json([Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_device_info_json(byte[] name, byte[] settings, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_device_open(byte[] name, byte[] settings, double rateHz, out Handle device);
        [DllImport(Library)] internal static extern Status htex_device_rate_hz(Device device, out double rateHz);
        [DllImport(Library)] internal static extern Status htex_device_write(Device device, ref float samples, UIntPtr frames, uint timeoutMs, out UIntPtr written);
        [DllImport(Library)] internal static extern Status htex_device_status(Device device, ref DeviceCounts counts);
        [DllImport(Library)] internal static extern Status htex_device_finish(Device device);
        [DllImport(Library)] internal static extern Status htex_device_free(Handle device);
        [DllImport(Library)] internal static extern Status htex_scene_open(byte[] path, ref OpenOptionsC options, ref SceneOptions sceneOptions, out Handle scene);
        [DllImport(Library)] internal static extern Status htex_scene_from_bytes(byte[] bytes, UIntPtr length, ref FilesC files, ref OpenOptionsC options, ref SceneOptions sceneOptions, out Handle scene);
        [DllImport(Library)] internal static extern Status htex_scene_free(Handle scene);
        [DllImport(Library)] internal static extern Status htex_scene_plan_json(Scene scene, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_scene_rate_hz(Scene scene, out double rateHz);
        [DllImport(Library)] internal static extern Status htex_scene_set_finger(Scene scene, ref Finger finger);
        [DllImport(Library)] internal static extern Status htex_scene_render(Scene scene, ref float samples, UIntPtr frames, out UIntPtr rendered);
        [DllImport(Library, EntryPoint = "htex_scene_render")] internal static extern Status htex_scene_render_to(Scene scene, IntPtr samples, UIntPtr frames, out UIntPtr rendered);
        [DllImport(Library)] internal static extern Status htex_scene_stop(Scene scene);
    }
}
