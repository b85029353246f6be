// Imports .htexlib files.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using UnityEditor.AssetImporters;

namespace Htex.Editor
{
    /// <summary>Makes an HtexLibrary from a .htexlib file.</summary>
    [ScriptedImporter(1, "htexlib")]
    public sealed class HtexLibraryImporter : ScriptedImporter
    {
        public override void OnImportAsset(AssetImportContext context)
        {
            Import.Add(context, "library", HtexLibrary.FromBytes);
        }
    }
}
