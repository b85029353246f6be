// Imports .htex files.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using System.IO;
using UnityEditor.AssetImporters;

namespace Htex.Editor
{
    /// <summary>Makes an HtexTexture of a .htex file. Increase the version when the asset has other fields: Unity then imports all again.</summary>
    [ScriptedImporter(1, "htex")]
    public sealed class HtexTextureImporter : ScriptedImporter
    {
        public override void OnImportAsset(AssetImportContext context)
        {
            Import.Add(context, "texture", HtexTexture.FromBytes);
        }
    }

    /// <summary>What both importers do.</summary>
    internal static class Import
    {
        /// <summary>Makes the asset of a file, with the file's name as Unity expects it. What libhtex says of a file that it refuses is an
        /// error of the import.</summary>
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
