// Imports a library of textures; prints its name, the number of its textures and the name of one.
using System;
using System.IO;
using System.Linq;
using Htex;
using Htex.Editor;
using UnityEditor;

static class Libraries
{
    static int Main(string[] paths)
    {
        // The stub of Unity finds importers in assemblies that are loaded.
        Console.Error.WriteLine(typeof(HtexLibraryImporter).Name);
        AssetDatabase.ImportAsset(paths[0]);
        var imported = AssetDatabase.LoadAssetAtPath<HtexLibrary>(paths[0]);
        if (!imported.Bytes.SequenceEqual(File.ReadAllBytes(paths[0])))
            return 1;
        using (var library = imported.Open())
        using (var texture = library.Asset("floor/vinyl"))
            Console.WriteLine("{0}: {1}, {2}", imported.Title, imported.Count, texture.Name);
        return 0;
    }
}
