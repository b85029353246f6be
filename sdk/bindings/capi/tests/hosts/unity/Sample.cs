// The script of the sample, as the scene has it: it loads the texture, enables the source, and the texture sounds while the mouse moves.
using System;
using System.IO;
using System.Linq;
using System.Reflection;
using Htex;
using Htex.Samples;
using UnityEngine;

static class Sample
{
    static void Call(object component, string name, params object[] arguments)
    {
        component.GetType().GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(component, arguments);
    }

    static float Loudest(HtexSource source)
    {
        var data = new float[2 * 4800];
        Call(source, "OnAudioFilterRead", data, 2);
        return data.Skip(4800).Max(sample => Math.Abs(sample));
    }

    static int Main(string[] paths)
    {
        Resources.Loaded["Vinyl"] = HtexTexture.FromBytes(File.ReadAllBytes(paths[0]));
        var thing = new GameObject("Texture");
        thing.SetActive(false);
        var source = thing.AddComponent<HtexSource>();
        source.enabled = false;
        var pad = thing.AddComponent<TouchPad>();
        thing.SetActive(true);
        Event.current.type = EventType.Repaint;
        Call(pad, "OnGUI");
        float resting = Loudest(source);
        // 8 pixels of 0.1 mm in 10 ms.
        Event.current.mousePosition = new Vector2 { x = 8.0f };
        Call(pad, "OnGUI");
        Console.WriteLine("speed {0:F0} force {1:F1}", source.SpeedMmS, source.ForceN);
        return source.enabled && resting == 0.0f && Loudest(source) > 0.001f && Debug.Errors == 0 ? 0 : 1;
    }
}
