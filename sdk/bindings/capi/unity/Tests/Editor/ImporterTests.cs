// The importer of .htex files.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System.IO;
using System.Text.RegularExpressions;
using NUnit.Framework;
using UnityEditor;
using UnityEngine;
using UnityEngine.TestTools;

namespace Htex.Editor.Tests
{
    public sealed class ImporterTests
    {
        private const string Vinyl = "Packages/org.htex.htex/Samples~/Touch/Resources/Vinyl.htex";
        private const string Imported = "Assets/HtexImporterTests.htex";

        [TearDown]
        public void Delete()
        {
            AssetDatabase.DeleteAsset(Imported);
        }

        [Test]
        public void AFileBecomesATextureWithItsBytes()
        {
            byte[] bytes = File.ReadAllBytes(Path.GetFullPath(Vinyl));
            File.WriteAllBytes(Imported, bytes);
            AssetDatabase.ImportAsset(Imported);
            var texture = AssetDatabase.LoadAssetAtPath<HtexTexture>(Imported);
            Assert.AreEqual("HtexImporterTests", texture.name);
            Assert.AreEqual("vinyl (simulated)", texture.Title);
            Assert.AreEqual(bytes, texture.Bytes);
            using (var asset = Asset.FromBytes(bytes))
                Assert.AreEqual(asset.Models, texture.Models);
        }

        [Test]
        public void AFileThatIsNoTextureIsAnErrorOfTheImport()
        {
            LogAssert.Expect(LogType.Error, new Regex("htex: .+"));
            File.WriteAllBytes(Imported, new byte[] { 80, 75, 3, 4 });
            AssetDatabase.ImportAsset(Imported);
            Assert.IsNull(AssetDatabase.LoadAssetAtPath<HtexTexture>(Imported));
        }

        [Test]
        public void AFileThatIsNoLibraryIsAnErrorOfTheImport()
        {
            const string Library = "Assets/HtexImporterTests.htexlib";
            LogAssert.Expect(LogType.Error, new Regex("htex: .+"));
            File.WriteAllBytes(Library, new byte[] { 1 });
            AssetDatabase.ImportAsset(Library);
            Assert.IsNull(AssetDatabase.LoadAssetAtPath<HtexLibrary>(Library));
            AssetDatabase.DeleteAsset(Library);
        }
    }
}
