// Code that set a log is unloaded while the library stays, as Unity's editor does when scripts change; the library then has messages.
using System;
using Htex;

sealed class Scripts : MarshalByRefObject
{
    public int Notes;

    public void SetLog()
    {
        LibHtex.SetLog((level, text) => Notes++);
    }

    public void Open(string scene)
    {
        Scene.Open(scene).Dispose();
    }

    public int Count()
    {
        return Notes;
    }
}

static class Reload
{
    static int Main(string[] paths)
    {
        var domain = AppDomain.CreateDomain("scripts");
        var scripts = (Scripts)domain.CreateInstanceAndUnwrap(typeof(Scripts).Assembly.FullName, typeof(Scripts).FullName);
        scripts.SetLog();
        new Scripts().Open(paths[0]);
        int notes = scripts.Count();
        AppDomain.Unload(domain);
        new Scripts().Open(paths[0]);
        Console.WriteLine("notes " + notes);
        return notes > 0 ? 0 : 1;
    }
}
