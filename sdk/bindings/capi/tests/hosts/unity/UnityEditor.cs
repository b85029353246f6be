// Stubs: the parts of UnityEditor that the package uses. Files are imported by the importer of their extension, as in Unity.
using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Reflection;
using UnityEditor.AssetImporters;
using UnityEngine;

namespace UnityEditor.AssetImporters
{
    [AttributeUsage(AttributeTargets.Class)]
    public sealed class ScriptedImporterAttribute : Attribute
    {
        internal readonly string Extension;

        public ScriptedImporterAttribute(int version, string ext)
        {
            Extension = ext;
        }
    }

    public abstract class ScriptedImporter
    {
        public abstract void OnImportAsset(AssetImportContext ctx);
    }

    public class AssetImportContext
    {
        private readonly List<UnityEngine.Object> objects = new List<UnityEngine.Object>();
        internal UnityEngine.Object Main;
        public string assetPath { get; internal set; }

        public void AddObjectToAsset(string identifier, UnityEngine.Object obj)
        {
            objects.Add(obj);
        }

        public void SetMainObject(UnityEngine.Object obj)
        {
            if (!objects.Contains(obj))
                throw new InvalidOperationException("the main object was not added");
            Main = obj;
        }

        public void LogImportError(string msg, UnityEngine.Object obj = null)
        {
            Debug.LogError(msg);
        }
    }
}

namespace UnityEditor
{
    public static class AssetDatabase
    {
        private static readonly Dictionary<string, UnityEngine.Object> Assets = new Dictionary<string, UnityEngine.Object>();

        public static void ImportAsset(string path)
        {
            var extension = Path.GetExtension(path).TrimStart('.');
            var types = AppDomain.CurrentDomain.GetAssemblies().SelectMany(assembly => assembly.GetTypes());
            var type = types.Single(candidate =>
            {
                var attribute = candidate.GetCustomAttribute<ScriptedImporterAttribute>();
                return attribute != null && attribute.Extension == extension;
            });
            var context = new AssetImportContext { assetPath = path };
            ((ScriptedImporter)Activator.CreateInstance(type)).OnImportAsset(context);
            Assets[path] = context.Main;
        }

        public static T LoadAssetAtPath<T>(string assetPath) where T : UnityEngine.Object
        {
            return (T)Assets[assetPath];
        }

        public static bool DeleteAsset(string path)
        {
            File.Delete(path);
            return Assets.Remove(path);
        }
    }
}
