// Htex.cs: libhtex for C#, in one file. C# 7.3, .NET Standard 2.0, mono, Unity (Mono and IL2CPP).
//
// Assets, libraries, voices, scenes and devices are SafeHandles: they are freed with Dispose, or when they are collected. A call holds its object:
// disposed of by another thread, it is freed when the call has returned, and later calls throw ObjectDisposedException. Calls that can
// fail throw HtexException; Voice.Render, RenderAdd, SetMotion, SetGain and Envelope, Scene.Render and Scene.SetFinger allocate nothing
// unless they fail, and may be called in an audio thread.
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
    /// <summary>Marks functions that native code calls, which compilers ahead of time find by this name. Unity has it.</summary>
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
    }

    /// <summary>Error of a call of libhtex.</summary>
    public sealed class HtexException : Exception
    {
        public Status Status { get; }

        internal HtexException(Status status, string text) : base(text)
        {
            Status = status;
        }
    }

    /// <summary>Motion of a finger over a texture.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Motion
    {
        internal uint Size;
        /// <summary>Scanning speed, mm/s; finite and not negative.</summary>
        public double SpeedMmS;
        /// <summary>Normal force, N; finite and not negative.</summary>
        public double ForceN;
        /// <summary>Position along the path, mm; NaN if it is not known.</summary>
        public double PositionMm;
        /// <summary>Place on the surface, mm; NaN if it is not known.</summary>
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
        /// <summary>Position, mm; both NaN if it is not known.</summary>
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

    /// <summary>A condition of a recording; NaN if it is not known.</summary>
    [Serializable, StructLayout(LayoutKind.Sequential)]
    public struct Condition
    {
        public double SpeedMmS, ForceN;
    }

    /// <summary>A band of frequencies.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Band
    {
        public double LowHz, HighHz;
    }

    /// <summary>What a voice played since it was last asked; see htex_voice_envelope.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Envelope
    {
        internal uint Size;
        /// <summary>RMS of the samples, in the asset's unit; 0 for none.</summary>
        public double LevelRms;
        /// <summary>Mean frequency, Hz; 0 for silence.</summary>
        public double CentroidHz;
        /// <summary>Number of the samples.</summary>
        public ulong Frames;
    }

    /// <summary>The engine of WASM modules; see htex_open_options.</summary>
    public enum Engine
    {
        /// <summary>Modules are not loaded.</summary>
        Off = 0,
        /// <summary>Modules run without handlers for signals.</summary>
        Checked = 1,
        /// <summary>Modules run with handlers for signals, which some runtimes of C# do not allow.</summary>
        Signals = 2,
    }

    /// <summary>Level of a message.</summary>
    public enum LogLevel
    {
        Info = 0,
        Warning = 1,
    }

    /// <summary>Options of a voice; null and 0 select the defaults.</summary>
    public sealed class VoiceOptions
    {
        public string Model;
        public double RateHz;
        public ulong Seed;
        public Motion? Motion;
        public string Synthesis;
        /// <summary>Gain of the samples; 0: 1.</summary>
        public double Gain;
        /// <summary>Greatest magnitude of a sample, in the asset's unit; 0: none.</summary>
        public double Limit;
        /// <summary>Number of bands of the envelope, 1 to 32; 0: no envelope.</summary>
        public int EnvelopeBands;
        public bool FrequencyScaling = true, LevelScaling = true, Contact = true;
        /// <summary>Highest level of a motion outside the recorded ones, over the strongest recorded level; 0: 4.</summary>
        public double Ceiling;
    }

    /// <summary>Options of opening an asset or a scene.</summary>
    public sealed class OpenOptions
    {
        /// <summary>Files of models to load.</summary>
        public string[] Plugins = new string[0];
        /// <summary>WASM modules of models, which run in a sandbox.</summary>
        public byte[][] Modules = new byte[0][];
        /// <summary>The engine that runs modules.</summary>
        public Engine Engine = Engine.Off;
        /// <summary>Folder for compiled modules; null: none is written.</summary>
        public string Cache;
        /// <summary>Whether models that assets bring along run, with an engine and in its sandbox.</summary>
        public bool Embedded = true;
        /// <summary>Whether installed models are searched for.</summary>
        public bool Installed;
    }

    /// <summary>
    /// Reads `count` bytes of a file from `offset` on to the start of `buffer`; throws if it cannot. It must not call the library. That of a
    /// library of textures is called by the threads that open textures, several at a time.
    /// </summary>
    public delegate void ReadAt(long offset, byte[] buffer, int count);

    /// <summary>An opened asset. Several threads may use it.</summary>
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

        /// <summary>Opens an asset of `length` bytes that a function reads, before this returns.</summary>
        public static Asset FromReader(long length, ReadAt read, OpenOptions options = null)
        {
            return FromReader(new FileReader(length, read, null), options);
        }

        /// <summary>Opens an asset that a stream holds from its start, which can seek and is left open.</summary>
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

        /// <summary>Band of the spectra.</summary>
        public Band Band
        {
            get
            {
                Band band;
                Native.Check(Native.htex_asset_band(this, out band));
                return band;
            }
        }

        /// <summary>Level of a voice, RMS in the asset's unit.</summary>
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

        /// <summary>Ids of the models of the representations.</summary>
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

        /// <summary>Magnitudes of the texture spectrum at frequencies in Hz, in the asset's unit.</summary>
        public double[] Magnitude(double[] frequencyHz, string model = null, Motion? at = null)
        {
            var magnitude = new double[frequencyHz.Length];
            Native.Check(Native.htex_asset_magnitude(this, Native.Utf8(model), Native.Sized(at), frequencyHz, magnitude, Native.Length(magnitude)));
            return magnitude;
        }

        /// <summary>Makes a voice.</summary>
        public Voice Voice(VoiceOptions options = null)
        {
            return new Voice(this, options ?? new VoiceOptions());
        }
    }

    /// <summary>An opened library: a file with thousands of textures. Several threads may use it.</summary>
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
        /// Opens a library of `length` bytes that a function reads, until the library is freed; `close` is then called, also after an error.
        /// </summary>
        public static Library FromReader(long length, ReadAt read, Action close = null)
        {
            return FromReader(new FileReader(length, read, close));
        }

        /// <summary>Opens a library that a stream holds from its start, which can seek. It is disposed of when the library is freed.</summary>
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

        /// <summary>Opens a texture; reads only its bytes.</summary>
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

        /// <summary>Number of textures.</summary>
        public ulong Count
        {
            get
            {
                ulong count;
                Native.Check(Native.htex_library_count(this, out count));
                return count;
            }
        }

        /// <summary>Number of pages of the index.</summary>
        public int PageCount
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_library_page_count(this, out count));
                return (int)count;
            }
        }

        /// <summary>The entries of a page of the index as a JSON array; see htex_library_page_json.</summary>
        public string PageJson(int page)
        {
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_page_json(this, (UIntPtr)page, o, c, out l));
        }

        /// <summary>The entry of a texture as JSON.</summary>
        public string EntryJson(string name)
        {
            var text = Native.Utf8(name);
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_entry_json(this, text, o, c, out l));
        }
    }

    /// <summary>A playing texture. One thread at a time may use it.</summary>
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

        /// <summary>The handle of the library; valid until the voice is disposed of, and an error of the calls after that.</summary>
        internal ulong Id { get { return (ulong)(long)handle; } }

        /// <summary>Sets the motion of the finger; spectrum and level glide to it.</summary>
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

        /// <summary>Renders the next samples to a part of an array.</summary>
        public void Render(float[] samples, int offset, int count)
        {
            Native.CheckPart(samples, offset, count);
            // A reference is passed twice as fast as an array; an empty array has none to pass.
            if (count > 0)
                Native.Check(Native.htex_voice_render(this, ref samples[offset], (UIntPtr)count));
            else
                Native.Check(Native.htex_voice_render(this, ref Native.None, UIntPtr.Zero));
        }

        /// <summary>Renders the next samples to memory. HtexNativeArray.cs has the same for the NativeArray of Unity.</summary>
        public void Render(IntPtr samples, int count)
        {
            Native.Check(Native.htex_voice_render_to(this, samples, Native.Count(count)));
        }

        /// <summary>Adds the next samples, multiplied by a gain, to a part of an array.</summary>
        public void RenderAdd(float[] samples, int offset, int count, float gain = 1.0f)
        {
            Native.CheckPart(samples, offset, count);
            if (count > 0)
                Native.Check(Native.htex_voice_render_add(this, ref samples[offset], (UIntPtr)count, gain));
        }

        /// <summary>Adds the next samples, multiplied by a gain, to memory.</summary>
        public void RenderAdd(IntPtr samples, int count, float gain = 1.0f)
        {
            Native.Check(Native.htex_voice_render_add_to(this, samples, Native.Count(count), gain));
        }

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP || UNITY_2021_2_OR_NEWER
        /// <summary>Renders the next samples to a span.</summary>
        public void Render(Span<float> samples)
        {
            Native.Check(Native.htex_voice_render(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length));
        }

        /// <summary>Adds the next samples, multiplied by a gain, to a span.</summary>
        public void RenderAdd(Span<float> samples, float gain = 1.0f)
        {
            Native.Check(Native.htex_voice_render_add(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length, gain));
        }
#endif

        /// <summary>Sets the gain, which changes within 10 ms.</summary>
        public void SetGain(double gain)
        {
            Native.Check(Native.htex_voice_set_gain(this, gain));
        }

        /// <summary>Whether the voice rests: its samples are 0 until a motion is felt again.</summary>
        public bool IsSilent
        {
            get
            {
                uint silent;
                Native.Check(Native.htex_voice_is_silent(this, out silent));
                return silent != 0;
            }
        }

        /// <summary>What was rendered since the last call. `bands` receives the mean squares, and has one place for each band; or is null.</summary>
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
        /// <summary>What was rendered since the last call, with the bands in a span.</summary>
        public Envelope Envelope(Span<double> bands)
        {
            var envelope = new Envelope { Size = Native.EnvelopeSize };
            Native.Check(Native.htex_voice_envelope(this, ref envelope, ref MemoryMarshal.GetReference(bands), (UIntPtr)bands.Length));
            return envelope;
        }
#endif

        /// <summary>Edges of a number of bands, Hz: one more than bands.</summary>
        public double[] EnvelopeEdges(int bands)
        {
            var edges = new double[bands + 1];
            Native.Check(Native.htex_voice_envelope_edges(this, edges, Native.Length(edges)));
            return edges;
        }

        /// <summary>Makes the voice as it was when it was made, at its own motion or another one. Not for an audio thread.</summary>
        public void Reset(Motion? motion = null)
        {
            Native.Check(Native.htex_voice_reset(this, Native.Sized(motion)));
        }

        /// <summary>Id of the model that plays.</summary>
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

        /// <summary>How a motion is played, and whether it is within the recorded conditions.</summary>
        public string Coverage(Motion motion)
        {
            motion.Size = Native.MotionSize;
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_voice_coverage(this, ref motion, o, c, out l));
        }
    }

    /// <summary>A playing scene. One thread at a time may use it.</summary>
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

        /// <summary>Opens a scene in memory, whose files a function returns by their names in the scene; null for one that is absent.</summary>
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

        /// <summary>The plan as JSON.</summary>
        public string PlanJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_scene_plan_json(this, o, c, out l)); }
        }

        /// <summary>Rate of the samples, Hz.</summary>
        public double RateHz
        {
            get
            {
                double rate;
                Native.Check(Native.htex_scene_rate_hz(this, out rate));
                return rate;
            }
        }

        /// <summary>Sets position and motion of the finger of a live scene.</summary>
        public void SetFinger(Finger finger)
        {
            finger.Size = Native.FingerSize;
            Native.Check(Native.htex_scene_set_finger(this, ref finger));
        }

        /// <summary>Renders the next samples; returns their number, which is smaller at the end.</summary>
        public int Render(float[] samples)
        {
            return Render(samples, 0, samples.Length);
        }

        /// <summary>Renders the next samples to a part of an array; returns their number.</summary>
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

        /// <summary>Renders the next samples to memory; returns their number.</summary>
        public int Render(IntPtr samples, int count)
        {
            UIntPtr rendered;
            Native.Check(Native.htex_scene_render_to(this, samples, Native.Count(count), out rendered));
            return (int)rendered;
        }

#if NETSTANDARD2_1_OR_GREATER || NETCOREAPP || UNITY_2021_2_OR_NEWER
        /// <summary>Renders the next samples to a span; returns their number.</summary>
        public int Render(Span<float> samples)
        {
            UIntPtr rendered;
            Native.Check(Native.htex_scene_render(this, ref MemoryMarshal.GetReference(samples), (UIntPtr)samples.Length, out rendered));
            return (int)rendered;
        }
#endif

        /// <summary>Ends the scene with a ramp to silence.</summary>
        public void Stop()
        {
            Native.Check(Native.htex_scene_stop(this));
        }
    }

    /// <summary>A device that is open: what plays the samples. One thread at a time may use it. One that is disposed before it is finished
    /// goes to rest.</summary>
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

        /// <summary>The devices of the library as JSON; see htex_device_list_json.</summary>
        public static string ListJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_device_list_json(o, c, out l)); }
        }

        /// <summary>Settings, quantity, rates and what becomes of the samples as JSON; see htex_device_info_json.</summary>
        public static string InfoJson(string name, string settings = "")
        {
            byte[] n = Native.Utf8(name), s = Native.Utf8(settings);
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_device_info_json(n, s, o, c, out l));
        }

        /// <summary>Opens a device, such as sdl; settings are lines NAME=VALUE, and a rate of 0 is the device's own.</summary>
        public static Device Open(string name, string settings = "", double rateHz = 0)
        {
            Native.Handle device;
            Native.Check(Native.htex_device_open(Native.Utf8(name), Native.Utf8(settings), rateHz, out device));
            return new Device(device.Id);
        }

        /// <summary>Rate of the samples, Hz.</summary>
        public double RateHz
        {
            get
            {
                double rate;
                Native.Check(Native.htex_device_rate_hz(this, out rate));
                return rate;
            }
        }

        /// <summary>Gives samples to the device, as many as it takes within the time; returns their number.</summary>
        public int Write(float[] samples, int offset, int count, int timeoutMs = 1000)
        {
            Native.CheckPart(samples, offset, count);
            UIntPtr written = UIntPtr.Zero;
            if (count > 0)
                Native.Check(Native.htex_device_write(this, ref samples[offset], (UIntPtr)count, (uint)Math.Max(timeoutMs, 0), out written));
            return (int)written;
        }

        /// <summary>What the device did so far.</summary>
        public DeviceCounts Counts
        {
            get
            {
                var counts = new DeviceCounts { Size = (uint)Marshal.SizeOf(typeof(DeviceCounts)) };
                Native.Check(Native.htex_device_status(this, ref counts));
                return counts;
            }
        }

        /// <summary>Plays what was written to its end, and keeps the result.</summary>
        public void Finish()
        {
            Native.Check(Native.htex_device_finish(this));
        }
    }

    /// <summary>What a device did since it was opened; see htex_device_counts.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct DeviceCounts
    {
        internal uint Size;
        /// <summary>Samples that it took.</summary>
        public ulong FramesWritten;
        /// <summary>Samples that came out.</summary>
        public ulong FramesPlayed;
        /// <summary>Times it ran dry.</summary>
        public ulong Underruns;
        /// <summary>Time from writing a sample to its output, s.</summary>
        public double LatencyS;
        /// <summary>Largest magnitude written, in the device's unit.</summary>
        public double Peak;
    }

    /// <summary>What concerns the library as a whole.</summary>
    public static class LibHtex
    {
        private static readonly Native.Log Passing = Pass;
        private static volatile Action<LogLevel, string> receiver;

        static LibHtex()
        {
            // The editor of Unity unloads this code when scripts change, and the library stays: it must not call what is gone.
            AppDomain.CurrentDomain.DomainUnload += (sender, unloaded) => Forget();
        }

        private static void Forget()
        {
            if (receiver != null)
                SetLog(null);
        }

        /// <summary>Version of the library.</summary>
        public static string Version { get { return Native.FromUtf8(Native.htex_version()); } }

        /// <summary>What a status means.</summary>
        public static string Text(Status status)
        {
            return Native.FromUtf8(Native.htex_status_text(status));
        }

        /// <summary>Sets the function that receives messages; null: none. It must not call the library.</summary>
        public static void SetLog(Action<LogLevel, string> log)
        {
            receiver = log;
            Native.Check(Native.htex_set_log(log == null ? null : Passing, IntPtr.Zero));
        }

        /// <summary>Frees all that the library has; no other call may run. Objects that are left are dead.</summary>
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
                // An exception cannot pass through the library; the message is lost.
            }
        }
    }

    /// <summary>A file that the program reads, held until the library has closed it.</summary>
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
            // It has one position for all threads.
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

        /// <summary>The struct for the library, which closes it once.</summary>
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
                // An exception cannot pass through the library: the file cannot be read.
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
                // Nor can this one; the file is not read any more.
            }
        }
    }

    /// <summary>The files of a scene, which a function returns.</summary>
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
                // An exception cannot pass through the library: the file counts as absent.
                bytes = null;
            }
            if (bytes == null)
                return 1;
            file = new FileReader(bytes.Length, (offset, buffer, count) => Array.Copy(bytes, offset, buffer, 0, count), null).Held();
            return 0;
        }
    }

    /// <summary>The functions of htex.h. An object that is passed is held during the call.</summary>
    internal static class Native
    {
#if UNITY_IOS && !UNITY_EDITOR
        internal const string Library = "__Internal";
#else
        internal const string Library = "htex";
#endif

        /// <summary>What an empty array refers to; never written.</summary>
        internal static float None;
        internal static double NoBand;

        internal static readonly uint MotionSize = (uint)Marshal.SizeOf(typeof(Motion));
        internal static readonly uint FingerSize = (uint)Marshal.SizeOf(typeof(Finger));
        internal static readonly uint EnvelopeSize = (uint)Marshal.SizeOf(typeof(Envelope));

        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        internal delegate void Log(LogLevel level, IntPtr message, IntPtr context);

        /// <summary>A motion as an array, with its size; null for none.</summary>
        internal static Motion[] Sized(Motion? motion)
        {
            if (!motion.HasValue)
                return null;
            var motions = new[] { motion.Value };
            motions[0].Size = MotionSize;
            return motions;
        }

        /// <summary>The address of a static function. Its delegate must live as long as native code has the address. The overload for a
        /// delegate of any type needs no generic code, which a compiler ahead of time could miss.</summary>
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
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct SceneOptions
        {
            internal uint Size;
            internal double RateHz;
        }

        /// <summary>Options of opening; all that they point to stays in place until they are disposed of.</summary>
        internal sealed class Open : IDisposable
        {
            internal OpenOptionsC Options;
            private readonly List<GCHandle> pinned = new List<GCHandle>();

            internal Open(OpenOptions options)
            {
                options = options ?? new OpenOptions();
                var plugins = Array.ConvertAll(options.Plugins, plugin => Keep(Utf8(plugin)));
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
