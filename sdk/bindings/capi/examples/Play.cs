// Plays an asset along a stroke that speeds up, and writes the samples as 32-bit floats.
//
//     mcs Play.cs Htex.cs
//     LD_LIBRARY_PATH=lib mono Play.exe sandpaper.htex stroke.f32
using System;
using System.IO;
using Htex;

static class Play
{
    static int Main(string[] arguments)
    {
        if (arguments.Length != 2)
        {
            Console.Error.WriteLine("usage: Play.exe ASSET.htex OUT.f32");
            return 2;
        }
        try
        {
            using (var asset = Asset.Open(arguments[0]))
            using (var voice = asset.Voice(new VoiceOptions { Seed = 7 }))
            using (var file = new BinaryWriter(File.Create(arguments[1])))
            {
                var samples = new float[64];
                for (int block = 0; block < 625; block++) // 2 s at 20 kHz
                {
                    voice.SetMotion(new Motion(40.0 + 0.2 * block, 0.4));
                    voice.Render(samples);
                    foreach (float sample in samples)
                        file.Write(sample);
                }
            }
            return 0;
        }
        catch (HtexException error)
        {
            Console.Error.WriteLine(error.Status + ": " + error.Message);
            return 1;
        }
    }
}
