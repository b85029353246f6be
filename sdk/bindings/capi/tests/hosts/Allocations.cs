// What the calls of an audio thread allocate on the heap of C#: HtexSource, a voice with all that it is told in a block, and a job.
using System;
using System.IO;
using System.Reflection;
using Htex;
using Unity.Collections;

static class Allocations
{
    const int Calls = 10000;

    /// Bytes that the calls after the first ones allocate; those compile.
    static long Bytes(Action call)
    {
        for (int i = 0; i < 10; i++)
            call();
        long before = GC.GetAllocatedBytesForCurrentThread();
        for (int i = 0; i < Calls; i++)
            call();
        return GC.GetAllocatedBytesForCurrentThread() - before;
    }

    static bool IsFree(string name, Action call)
    {
        long bytes = Bytes(call);
        Console.WriteLine(name + " " + bytes);
        return bytes == 0;
    }

    static int Main(string[] paths)
    {
        var texture = HtexTexture.FromBytes(File.ReadAllBytes(paths[0]));
        var source = new HtexSource { Texture = texture, SpeedMmS = 80.0f };
        var flags = BindingFlags.Instance | BindingFlags.NonPublic;
        source.GetType().GetMethod("OnEnable", flags).Invoke(source, null);
        var method = source.GetType().GetMethod("OnAudioFilterRead", flags);
        var filter = (Action<float[], int>)Delegate.CreateDelegate(typeof(Action<float[], int>), source, method);
        var data = new float[2 * 256];
        object boxed = null;
        // A measure that sees nothing would pass: boxes take at least 16 bytes each.
        bool isSeen = Bytes(() => boxed = data.Length) >= 16 * Calls && boxed != null;
        bool isFree = IsFree("source", () =>
        {
            source.SpeedMmS += 0.001f;
            filter(data, 2);
        });
        using (var asset = texture.Open())
        using (var voice = asset.Voice(new VoiceOptions { EnvelopeBands = 3 }))
        using (var native = new NativeArray<float>(256))
        {
            var bands = new double[3];
            isFree &= IsFree("voice", () =>
            {
                voice.SetMotion(new Motion(80.0, 0.4));
                voice.SetGain(0.5);
                voice.Render(data);
                voice.RenderAdd(data, 10, 20);
                voice.Render(native);
                voice.Envelope(bands);
                bool isSilent = voice.IsSilent;
            });
            var job = new HtexVoice(voice);
            isFree &= IsFree("job", () =>
            {
                job.SetMotion(new Motion(80.0, 0.4));
                job.Render(native);
                job.RenderAdd(native, 0.5f);
            });
        }
        return isSeen && isFree && data[0] != 0.0f && UnityEngine.Debug.Errors == 0 ? 0 : 1;
    }
}
