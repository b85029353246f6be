// Imports .htex files.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using System.IO;
using UnityEditor.AssetImporters;

namespace Htex.Editor
{
    /// <summary>
    /// Makes an HtexTexture from a .htex file. If you change the fields of HtexTexture, increase
    /// the version: Unity then imports all files again.
    /// </summary>
    [ScriptedImporter(1, "htex")]
    public sealed class HtexTextureImporter : ScriptedImporter
    {
        public override void OnImportAsset(AssetImportContext context)
        {
            Import.Add(context, "texture", HtexTexture.FromBytes);
        }
    }

    /// <summary>The code that both importers share.</summary>
    internal static class Import
    {
        /// <summary>
        /// Makes the Unity asset of a file. The asset gets the file's name, as Unity expects. If
        /// libhtex refuses the file, its error text becomes an error of the import.
        /// </summary>
        internal static void Add<T>(AssetImportContext context, string identifier, Func<byte[], T> make) where T : UnityEngine.Object
        {
            try
            {
                T made = make(File.ReadAllBytes(context.assetPath));
                made.name = Path.GetFileNameWithoutExtension(context.assetPath);
                context.AddObjectToAsset(identifier, made);
                context.SetMainObject(made);
            }
            catch (HtexException error)
            {
                context.LogImportError("htex: " + error.Message);
            }
            catch (DllNotFoundException error)
            {
                context.LogImportError("htex: the library is not there; see Plugins in the documentation of the package: " + error.Message);
            }
        }
    }
}
