// Htex.cs: libhtex for C#, in one file. C# 7.3, .NET Standard 2.0, mono, Unity (Mono and IL2CPP).
//
// Assets, libraries, voices and scenes are SafeHandles: they are freed with Dispose, or when they are collected. Calls that can fail throw
// HtexException; Voice.Render, Voice.SetMotion, Scene.Render and Scene.SetFinger allocate nothing unless they fail, and may be
// called in an audio thread.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

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
        /// <summary>Scanning speed, mm/s; negative on the back stroke.</summary>
        public double SpeedMmS;
        /// <summary>Normal force, N; not negative.</summary>
        public double ForceN;
        /// <summary>Position, mm; both NaN if it is not known.</summary>
        public double XMm, YMm;

        public Finger(double speedMmS, double forceN, double xMm = double.NaN, double yMm = double.NaN)
        {
            SpeedMmS = speedMmS;
            ForceN = forceN;
            XMm = xMm;
            YMm = yMm;
        }
    }

    /// <summary>A condition of a recording; NaN if it is not known.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Condition
    {
        public double SpeedMmS, ForceN;
    }

    /// <summary>Options of a voice; null and 0 select the defaults.</summary>
    public sealed class VoiceOptions
    {
        public string Model;
        public double RateHz;
        public ulong Seed;
        public Motion? Motion;
        public string Synthesis;
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
        /// <summary>Whether models that assets bring along run, in a sandbox.</summary>
        public bool Embedded = true;
        /// <summary>Whether installed models are searched for.</summary>
        public bool Installed;
    }

    /// <summary>An opened asset. Several threads may use it.</summary>
    public sealed class Asset : SafeHandle
    {
        internal Asset(ulong id) : base(IntPtr.Zero, true)
        {
            Native.Keep(this, id, SetHandle);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        internal Native.Handle Id { get { return new Native.Handle { Id = (ulong)(long)handle }; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_asset_free(Id) == Status.Ok;
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

        /// <summary>The manifest as JSON.</summary>
        public string ManifestJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_manifest_json(Id, o, c, out l)); }
        }

        /// <summary>Unit of the samples.</summary>
        public string Unit
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_unit(Id, o, c, out l)); }
        }

        /// <summary>Ids of the models of the representations.</summary>
        public string[] Models
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_asset_representation_count(Id, out count));
                var models = new string[(int)count];
                for (int i = 0; i < models.Length; i++)
                {
                    var index = (UIntPtr)i;
                    models[i] = Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_asset_representation_model(Id, index, o, c, out l));
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
                Native.Check(Native.htex_asset_condition_count(Id, out count));
                var conditions = new Condition[(int)count];
                for (int i = 0; i < conditions.Length; i++)
                    Native.Check(Native.htex_asset_condition(Id, (UIntPtr)i, out conditions[i]));
                return conditions;
            }
        }

        /// <summary>Magnitudes of the texture spectrum at frequencies in Hz, in the asset's unit.</summary>
        public double[] Magnitude(double[] frequencyHz, string model = null, Motion? at = null)
        {
            var magnitude = new double[frequencyHz.Length];
            var motions = at.HasValue ? new[] { at.Value } : null;
            Native.Check(Native.htex_asset_magnitude(Id, Native.Utf8(model), motions, frequencyHz, magnitude, Native.Length(magnitude)));
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

        private Native.Handle Id { get { return new Native.Handle { Id = (ulong)(long)handle }; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_library_free(Id) == Status.Ok;
        }

        public static Library Open(string path)
        {
            Native.Handle library;
            Native.Check(Native.htex_library_open(Native.Utf8(path), out library));
            return new Library(library.Id);
        }

        /// <summary>Opens a texture; reads only its bytes.</summary>
        public Asset Asset(string name, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                Native.Handle asset;
                Native.Check(Native.htex_library_asset(Id, Native.Utf8(name), ref open.Options, out asset));
                return new Asset(asset.Id);
            }
        }

        public string Name
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_name(Id, o, c, out l)); }
        }

        /// <summary>Number of textures.</summary>
        public ulong Count
        {
            get
            {
                ulong count;
                Native.Check(Native.htex_library_count(Id, out count));
                return count;
            }
        }

        /// <summary>Number of pages of the index.</summary>
        public int PageCount
        {
            get
            {
                UIntPtr count;
                Native.Check(Native.htex_library_page_count(Id, out count));
                return (int)count;
            }
        }

        /// <summary>The entries of a page of the index as a JSON array; see htex_library_page_json.</summary>
        public string PageJson(int page)
        {
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_page_json(Id, (UIntPtr)page, o, c, out l));
        }

        /// <summary>The entry of a texture as JSON.</summary>
        public string EntryJson(string name)
        {
            var text = Native.Utf8(name);
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_library_entry_json(Id, text, o, c, out l));
        }
    }

    /// <summary>A playing texture. One thread at a time may use it.</summary>
    public sealed class Voice : SafeHandle
    {
        internal Voice(Asset asset, VoiceOptions options) : base(IntPtr.Zero, true)
        {
            var model = Native.Pin(Native.Utf8(options.Model));
            var synthesis = Native.Pin(Native.Utf8(options.Synthesis));
            var motion = Native.Pin(options.Motion.HasValue ? new[] { options.Motion.Value } : null);
            try
            {
                var c = new Native.VoiceOptions
                {
                    Size = (UIntPtr)Marshal.SizeOf(typeof(Native.VoiceOptions)),
                    Model = Native.Address(model),
                    RateHz = options.RateHz,
                    Seed = options.Seed,
                    Motion = Native.Address(motion),
                    Synthesis = Native.Address(synthesis),
                    NoFrequencyScaling = options.FrequencyScaling ? 0u : 1u,
                    NoLevelScaling = options.LevelScaling ? 0u : 1u,
                    NoContact = options.Contact ? 0u : 1u,
                    Ceiling = options.Ceiling,
                };
                Native.Handle voice;
                Native.Check(Native.htex_voice_new(asset.Id, ref c, out voice));
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

        private Native.Handle Id { get { return new Native.Handle { Id = (ulong)(long)handle }; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_voice_free(Id) == Status.Ok;
        }

        /// <summary>Sets the motion of the finger; spectrum and level glide to it.</summary>
        public void SetMotion(Motion motion)
        {
            Native.Check(Native.htex_voice_set_motion(Id, ref motion));
        }

        /// <summary>Renders the next samples, in the asset's unit.</summary>
        public void Render(float[] samples)
        {
            // A reference is passed twice as fast as an array; an empty array has none to pass.
            if (samples.Length > 0)
                Native.Check(Native.htex_voice_render(Id, ref samples[0], (UIntPtr)samples.Length));
            else
                Native.Check(Native.htex_voice_render(Id, ref Native.None, UIntPtr.Zero));
        }

        /// <summary>Renders a block of `frames` samples for each motion.</summary>
        public void RenderPath(Motion[] motions, float[] samples, int frames)
        {
            if ((long)motions.Length * frames != samples.Length)
                throw new ArgumentException("samples has not one block of `frames` for each motion", "samples");
            Native.Check(Native.htex_voice_render_path(Id, motions, Native.Length(motions), samples, (UIntPtr)frames));
        }

        /// <summary>How a motion is played, and whether it is within the recorded conditions.</summary>
        public string Coverage(Motion motion)
        {
            return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_voice_coverage(Id, ref motion, o, c, out l));
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

        private Native.Handle Id { get { return new Native.Handle { Id = (ulong)(long)handle }; } }

        protected override bool ReleaseHandle()
        {
            return Native.htex_scene_free(Id) == Status.Ok;
        }

        public static Scene Open(string path, double rateHz = 0, OpenOptions options = null)
        {
            using (var open = new Native.Open(options))
            {
                var c = new Native.SceneOptions { Size = (UIntPtr)Marshal.SizeOf(typeof(Native.SceneOptions)), RateHz = rateHz };
                Native.Handle scene;
                Native.Check(Native.htex_scene_open(Native.Utf8(path), ref open.Options, ref c, out scene));
                return new Scene(scene.Id);
            }
        }

        /// <summary>The plan as JSON.</summary>
        public string PlanJson
        {
            get { return Native.Text((byte[] o, UIntPtr c, out UIntPtr l) => Native.htex_scene_plan_json(Id, o, c, out l)); }
        }

        /// <summary>Rate of the samples, Hz.</summary>
        public double RateHz
        {
            get
            {
                double rate;
                Native.Check(Native.htex_scene_rate_hz(Id, out rate));
                return rate;
            }
        }

        /// <summary>Sets position and motion of the finger of a live scene.</summary>
        public void SetFinger(Finger finger)
        {
            Native.Check(Native.htex_scene_set_finger(Id, ref finger));
        }

        /// <summary>Renders the next samples; returns their number, which is smaller at the end.</summary>
        public int Render(float[] samples)
        {
            UIntPtr rendered;
            if (samples.Length > 0)
                Native.Check(Native.htex_scene_render(Id, ref samples[0], (UIntPtr)samples.Length, out rendered));
            else
                Native.Check(Native.htex_scene_render(Id, ref Native.None, UIntPtr.Zero, out rendered));
            return (int)rendered;
        }

        /// <summary>Ends the scene with a ramp to silence.</summary>
        public void Stop()
        {
            Native.Check(Native.htex_scene_stop(Id));
        }
    }

    /// <summary>The functions of htex.h.</summary>
    internal static class Native
    {
#if UNITY_IOS && !UNITY_EDITOR
        private const string Library = "__Internal";
#else
        private const string Library = "htex";
#endif

        /// <summary>What an empty array refers to; never written.</summary>
        internal static float None;

        [StructLayout(LayoutKind.Sequential)]
        internal struct Handle
        {
            internal ulong Id;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct OpenOptionsC
        {
            internal UIntPtr Size;
            internal IntPtr Plugins;
            internal UIntPtr PluginsLen;
            internal uint NoEmbedded, Installed;
            internal IntPtr Modules;
            internal UIntPtr ModulesLen;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct Bytes
        {
            internal IntPtr Data;
            internal UIntPtr Len;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct VoiceOptions
        {
            internal UIntPtr Size;
            internal IntPtr Model;
            internal double RateHz;
            internal ulong Seed;
            internal IntPtr Motion, Synthesis;
            internal uint NoFrequencyScaling, NoLevelScaling, NoContact;
            internal double Ceiling;
        }

        [StructLayout(LayoutKind.Sequential)]
        internal struct SceneOptions
        {
            internal UIntPtr Size;
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
                    Size = (UIntPtr)Marshal.SizeOf(typeof(OpenOptionsC)),
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

        private static string FromUtf8(IntPtr text)
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
        [DllImport(Library)] internal static extern Status htex_asset_open(byte[] path, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_from_bytes(byte[] bytes, UIntPtr length, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_free(Handle asset);
        [DllImport(Library)] internal static extern Status htex_asset_manifest_json(Handle asset, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_unit(Handle asset, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_condition_count(Handle asset, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_asset_condition(Handle asset, UIntPtr index, out Condition condition);
        [DllImport(Library)] internal static extern Status htex_asset_representation_count(Handle asset, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_asset_representation_model(Handle asset, UIntPtr index, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_asset_magnitude(Handle asset, byte[] model, Motion[] at, double[] frequencyHz, [Out] double[] magnitude, UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_open(byte[] path, out Handle library);
        [DllImport(Library)] internal static extern Status htex_library_free(Handle library);
        [DllImport(Library)] internal static extern Status htex_library_name(Handle library, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_count(Handle library, out ulong count);
        [DllImport(Library)] internal static extern Status htex_library_page_count(Handle library, out UIntPtr count);
        [DllImport(Library)] internal static extern Status htex_library_page_json(Handle library, UIntPtr page, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_entry_json(Handle library, byte[] name, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_library_asset(Handle library, byte[] name, ref OpenOptionsC options, out Handle asset);
        [DllImport(Library)] internal static extern Status htex_voice_new(Handle asset, ref VoiceOptions options, out Handle voice);
        [DllImport(Library)] internal static extern Status htex_voice_free(Handle voice);
        [DllImport(Library)] internal static extern Status htex_voice_set_motion(Handle voice, ref Motion motion);
        [DllImport(Library)] internal static extern Status htex_voice_render(Handle voice, ref float samples, UIntPtr frames);
        [DllImport(Library)] internal static extern Status htex_voice_render_path(Handle voice, Motion[] motions, UIntPtr motionsLength, [Out] float[] samples, UIntPtr frames);
        [DllImport(Library)] internal static extern Status htex_voice_coverage(Handle voice, ref Motion motion, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_scene_open(byte[] path, ref OpenOptionsC options, ref SceneOptions sceneOptions, out Handle scene);
        [DllImport(Library)] internal static extern Status htex_scene_free(Handle scene);
        [DllImport(Library)] internal static extern Status htex_scene_plan_json(Handle scene, [Out] byte[] text, UIntPtr capacity, out UIntPtr length);
        [DllImport(Library)] internal static extern Status htex_scene_rate_hz(Handle scene, out double rateHz);
        [DllImport(Library)] internal static extern Status htex_scene_set_finger(Handle scene, ref Finger finger);
        [DllImport(Library)] internal static extern Status htex_scene_render(Handle scene, ref float samples, UIntPtr frames, out UIntPtr rendered);
        [DllImport(Library)] internal static extern Status htex_scene_stop(Handle scene);
    }
}
