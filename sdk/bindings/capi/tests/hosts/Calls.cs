// Prints what a voice, its asset and the library tell: each line is a name and its values.
using System;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using Htex;
using Unity.Collections;

static class Calls
{
    static void Print(string name, params double[] values)
    {
        var texts = values.Select(value => value.ToString("R", CultureInfo.InvariantCulture));
        Console.WriteLine(name + " " + string.Join(" ", texts));
    }

    static int Main(string[] paths)
    {
        if (!Readers.Work(paths[0], paths[1]))
            return 1;
        var open = new OpenOptions { Engine = Engine.Checked };
        using (var library = Library.FromBytes(File.ReadAllBytes(paths[1])))
        using (var asset = Asset.FromBytes(File.ReadAllBytes(paths[0]), open))
        using (var voice = asset.Voice(new VoiceOptions { Seed = 7, Gain = 0.5, Limit = 0.01, EnvelopeBands = 3, Fluctuation = true }))
        {
            Print("library", library.Count);
            Console.WriteLine("name " + asset.Name);
            Print("level", asset.LevelRms());
            Print("band", asset.Band.LowHz, asset.Band.HighHz);
            Console.WriteLine("model " + voice.Model);
            float[] samples = new float[4000], sum = new float[4010];
            var bands = new double[3];
            voice.Render(samples, 0, 1500);
            voice.Render(samples, 1500, 2500);
            var envelope = voice.Envelope(bands);
            Print("envelope", envelope.LevelRms, envelope.CentroidHz, bands[0], bands[1], bands[2]);
            var edges = voice.EnvelopeEdges(3);
            Print("edges", edges[1], edges[2]);
            try
            {
                voice.SetGain(-1.0);
                return 1;
            }
            catch (HtexException error)
            {
                if (error.Status != Status.InvalidArgument)
                    return 1;
            }
            voice.Reset();
            voice.RenderAdd(sum, 10, 2000);
            var pinned = GCHandle.Alloc(sum, GCHandleType.Pinned);
            voice.Render(IntPtr.Add(pinned.AddrOfPinnedObject(), 4 * 2010), 2000);
            pinned.Free();
            Print("again", samples.SequenceEqual(sum.Skip(10)) ? 1 : 0);
            if (!Memory.Is(asset, samples, bands, envelope))
                return 1;
            voice.SetMotion(new Motion(0.0, 0.0));
            voice.Render(samples);
            Print("silent", voice.IsSilent ? 1 : 0);
            Console.WriteLine("status " + LibHtex.Text(Status.Busy));
            try
            {
                voice.Render(samples, 3999, 2);
                return 1;
            }
            catch (ArgumentOutOfRangeException)
            {
            }
            if (!Devices.Play(voice, paths[3]))
                return 1;
            var folder = Path.GetDirectoryName(paths[2]);
            int notes = 0;
            LibHtex.SetLog((level, text) => notes++);
            Func<string, byte[]> files = name => File.ReadAllBytes(Path.Combine(folder, name));
            using (var scene = Scene.FromBytes(File.ReadAllBytes(paths[2]), files))
                if (scene.Render(samples, 10, 100) != 100 || !Memory.Is(scene, samples))
                    return 1;
            LibHtex.SetLog(null);
            try
            {
                Scene.FromBytes(File.ReadAllBytes(paths[2]), name => { throw new IOException(name); });
                return 1;
            }
            catch (HtexException error)
            {
                if (error.Status != Status.InvalidScene)
                    return 1;
            }
        }
        LibHtex.Shutdown();
        return 0;
    }
}

/// Samples of a voice to the device of many channels.
static class Devices
{
    internal static bool Play(Voice voice, string path)
    {
        var samples = new float[2000];
        voice.SetMotion(new Motion(80.0, 0.4));
        voice.Render(samples);
        if (!Device.InfoJson("sdl").Contains("\"mapping\"") || !Device.ListJson.Contains("org.htex.sdl"))
            return false;
        using (var device = Device.Open("channels", "to=file\npath=" + path, 48000))
        {
            int written = device.Write(samples, 0, 1500) + device.Write(samples, 1500, 500);
            var text = string.Format(CultureInfo.InvariantCulture, "device {0} {1} {2}", written, device.Counts.FramesWritten, device.RateHz);
            Console.WriteLine(text);
            device.Finish();
        }
        try
        {
            Device.Open("none");
            return false;
        }
        catch (HtexException error)
        {
            return error.Status == Status.InvalidArgument;
        }
    }
}

/// Files that a program reads.
static class Readers
{
    internal static bool Work(string asset, string library)
    {
        byte[] bytes = File.ReadAllBytes(asset), packed = File.ReadAllBytes(library);
        ReadAt whole = (offset, buffer, count) => Array.Copy(bytes, offset, buffer, 0, count);
        string manifest;
        using (var opened = Asset.FromBytes(bytes))
            manifest = opened.ManifestJson;
        using (var read = Asset.FromReader(bytes.Length, whole))
        using (var stream = new MemoryStream(bytes))
        using (var streamed = Asset.FromStream(stream))
            if (read.ManifestJson != manifest || streamed.ManifestJson != manifest || !stream.CanRead)
                return false;
        int reads = 0, closes = 0;
        ReadAt part = (offset, buffer, count) =>
        {
            reads++;
            Array.Copy(packed, offset, buffer, 0, count);
        };
        using (var read = Library.FromReader(packed.Length, part, () => closes++))
        using (var texture = read.Asset("a"))
            if (texture.ManifestJson != manifest || closes != 0 || reads < 2)
                return false;
        var file = File.OpenRead(library);
        using (var read = Library.FromStream(file))
            if (read.Count != 1)
                return false;
        return closes == 1 && !file.CanRead && Fails(packed.Length);
    }

    /// What a reader throws is an error of the library, and the reader is closed.
    static bool Fails(long length)
    {
        int closes = 0;
        ReadAt broken = (offset, buffer, count) => { throw new IOException("gone"); };
        try
        {
            Library.FromReader(length, broken, () => closes++);
            return false;
        }
        catch (HtexException error)
        {
            if (error.Status != Status.Io || closes != 1)
                return false;
        }
        try
        {
            Asset.FromReader(length, broken);
            return false;
        }
        catch (HtexException error)
        {
            return error.Status == Status.Io;
        }
    }
}

/// Samples in spans and native arrays are those in arrays.
static class Memory
{
    internal static bool Is(Asset asset, float[] samples, double[] bands, Envelope wanted)
    {
        using (var voice = asset.Voice(new VoiceOptions { Seed = 7, Gain = 0.5, Limit = 0.01, EnvelopeBands = 3, Fluctuation = true }))
        using (var native = new NativeArray<float>(1000))
        {
            var there = new float[4000];
            var measured = new double[3];
            voice.Render(new Span<float>(there, 0, 1500));
            voice.RenderAdd(new Span<float>(there, 1500, 500));
            voice.Render(Span<float>.Empty);
            voice.Render(native);
            native.CopyTo(there, 2000);
            native.Clear();
            voice.RenderAdd(native);
            native.CopyTo(there, 3000);
            var envelope = voice.Envelope(measured.AsSpan());
            return there.SequenceEqual(samples) && measured.SequenceEqual(bands) && envelope.LevelRms == wanted.LevelRms;
        }
    }

    internal static bool Is(Scene scene, float[] samples)
    {
        using (var native = new NativeArray<float>(50))
            return scene.Render(new Span<float>(samples, 0, 70)) == 70 && scene.Render(native) == 50;
    }
}
