// Prints the time of a sample, ns: the least of several runs over blocks of 64.
using System;
using System.Diagnostics;
using System.Globalization;
using Htex;

static class Block
{
    static void Main(string[] arguments)
    {
        const int blocks = 30000, runs = 5;
        using (var asset = Asset.Open(arguments[0]))
        using (var voice = asset.Voice(new VoiceOptions { Model = arguments[1], Seed = 7 }))
        {
            var samples = new float[64];
            double least = double.MaxValue;
            for (int run = 0; run < runs; run++)
            {
                var watch = Stopwatch.StartNew();
                for (int block = 0; block < blocks; block++)
                    voice.Render(samples);
                least = Math.Min(least, watch.Elapsed.TotalMilliseconds * 1e6 / (blocks * samples.Length));
            }
            Console.WriteLine(least.ToString("F4", CultureInfo.InvariantCulture));
        }
    }
}
