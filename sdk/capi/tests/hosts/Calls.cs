// Prints what a voice, its asset and the library tell: each line is a name and its values.
using System;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using Htex;

static class Calls
{
    static void Print(string name, params double[] values)
    {
        var texts = values.Select(value => value.ToString("R", CultureInfo.InvariantCulture));
        Console.WriteLine(name + " " + string.Join(" ", texts));
    }

    static int Main(string[] paths)
    {
        var open = new OpenOptions { Engine = Engine.Checked };
        using (var library = Library.FromBytes(File.ReadAllBytes(paths[1])))
        using (var asset = Asset.FromBytes(File.ReadAllBytes(paths[0]), open))
        using (var voice = asset.Voice(new VoiceOptions { Seed = 7, Gain = 0.5, Limit = 0.01, EnvelopeBands = 3 }))
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
            var folder = Path.GetDirectoryName(paths[0]);
            int notes = 0;
            LibHtex.SetLog((level, text) => notes++);
            Func<string, byte[]> files = name => File.ReadAllBytes(Path.Combine(folder, name));
            using (var scene = Scene.FromBytes(File.ReadAllBytes(paths[2]), files))
                if (scene.Render(samples, 10, 100) != 100)
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
