// HtexSource is enabled and disabled again and again while audio threads render: nothing fails, and nothing is left.
using System;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Threading;
using Htex;

static class Toggles
{
    const int Rounds = 2000;

    static T Bound<T>(object source, string name)
    {
        var method = typeof(HtexSource).GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic);
        return (T)(object)Delegate.CreateDelegate(typeof(T), source, method);
    }

    /// The place of an object in the library's table: the lower 27 bits of its handle. Objects that are not freed keep theirs.
    static long Place(SafeHandle handle)
    {
        return (long)handle.DangerousGetHandle() & 0x7ffffff;
    }

    static int Main(string[] paths)
    {
        UnityEngine.Application.streamingAssetsPath = paths[0];
        var source = new HtexSource { Asset = paths[1], SpeedMmS = 80.0f };
        Action enable = Bound<Action>(source, "OnEnable"), disable = Bound<Action>(source, "OnDisable");
        Action update = Bound<Action>(source, "Update");
        var filter = Bound<Action<float[], int>>(source, "OnAudioFilterRead");
        bool stop = false;
        long blocks = 0, sounding = 0;
        // One thread renders without a pause, as one does at full load.
        var audio = new Thread(() =>
        {
            var data = new float[2 * 256];
            while (!Volatile.Read(ref stop))
            {
                Array.Clear(data, 0, data.Length);
                filter(data, 2);
                blocks++;
                foreach (float sample in data)
                    if (sample != 0.0f)
                    {
                        sounding++;
                        break;
                    }
            }
        });
        audio.Start();
        for (int round = 0; round < Rounds; round++)
        {
            enable();
            if (round % 4 == 0)
                Thread.Sleep(1);
            update();
            disable();
        }
        Volatile.Write(ref stop, true);
        audio.Join();
        update();
        GC.Collect();
        GC.WaitForPendingFinalizers();
        using (var asset = Asset.Open(System.IO.Path.Combine(paths[0], paths[1])))
        using (var voice = asset.Voice())
        {
            Console.WriteLine("{0} blocks, {1} sounding, {2} errors", blocks, sounding, UnityEngine.Debug.Errors);
            Console.WriteLine("places {0} {1}", Place(asset), Place(voice));
            bool left = Place(asset) > 2 || Place(voice) > 2;
            try
            {
                voice.Dispose();
                voice.Render(new float[4]);
                return 3;
            }
            catch (ObjectDisposedException)
            {
            }
            return sounding == 0 || left || UnityEngine.Debug.Errors > 0 ? 1 : 0;
        }
    }
}
