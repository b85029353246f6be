// Textures as assets, and the component that plays them.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System.IO;
using NUnit.Framework;
using Unity.Collections;
using UnityEngine;

namespace Htex.Tests
{
    public sealed class TextureTests
    {
        private const string Vinyl = "Packages/org.htex.htex/Samples~/Touch/Resources/Vinyl.htex";

        /// <summary>The texture of the sample. Only the editor has the files of packages.</summary>
        private static HtexTexture Texture()
        {
            string path = Path.GetFullPath(Vinyl);
            if (!File.Exists(path))
                Assert.Ignore("no " + path);
            return HtexTexture.FromBytes(File.ReadAllBytes(path));
        }

        [Test]
        public void TheLibraryIsThere()
        {
            Assert.IsTrue(LibHtex.Version.StartsWith("0."));
        }

        [Test]
        public void ATextureKnowsWhatItsFileStates()
        {
            var texture = Texture();
            Assert.AreEqual("vinyl (simulated)", texture.Title);
            Assert.AreEqual("lateral_force", texture.Quantity);
            Assert.AreEqual("N", texture.Unit);
            Assert.AreEqual("org.htex.ar", texture.Models[0]);
            Assert.AreEqual(1, texture.Conditions.Length);
            Assert.AreEqual(80.0, texture.Conditions[0].SpeedMmS);
            Assert.AreEqual(0.4, texture.Conditions[0].ForceN);
        }

        [Test]
        public void OtherBytesAreRefusedWithATextOfTheLibrary()
        {
            var error = Assert.Throws<HtexException>(() => HtexTexture.FromBytes(new byte[] { 1, 2, 3 }));
            Assert.AreEqual(Status.InvalidAsset, error.Status);
            Assert.IsTrue(error.Message.Length > 0);
        }

        [Test]
        public void AJobRendersTheSamplesOfTheVoice()
        {
            var options = new VoiceOptions { Seed = 7 };
            var motion = new Motion(80.0, 0.4);
            using (var asset = Texture().Open())
            using (Voice here = asset.Voice(options), there = asset.Voice(options))
            using (var samples = new NativeArray<float>(256, Allocator.Persistent))
            using (var result = new NativeArray<int>(1, Allocator.Persistent))
            {
                var expected = new float[256];
                here.SetMotion(motion);
                here.Render(expected);
                var job = new HtexRenderJob { Voice = new HtexVoice(there), Motion = motion, Samples = samples, Result = result };
                job.Execute();
                Assert.AreEqual((int)Status.Ok, result[0]);
                Assert.IsTrue(expected[255] != 0.0f);
                for (int i = 0; i < expected.Length; i++)
                    Assert.AreEqual(expected[i], samples[i]);
                there.Dispose();
                job.Execute();
                Assert.AreEqual((int)Status.BadHandle, result[0]);
            }
        }

        [Test]
        public void ASourceTakesItsTexture()
        {
            var thing = new GameObject("texture");
            thing.SetActive(false);
            var source = thing.AddComponent<HtexSource>();
            source.Asset = "is not there.htex";
            source.Texture = Texture();
            thing.SetActive(true);
            // It is disabled if it could not open what it plays.
            Assert.IsTrue(source.enabled);
            Object.DestroyImmediate(thing);
        }
    }
}
