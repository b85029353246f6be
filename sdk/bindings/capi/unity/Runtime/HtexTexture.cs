// A .htex file as a Unity asset. The asset holds the bytes, so it also plays on systems where
// StreamingAssets are not files, such as Android.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using UnityEngine;

namespace Htex
{
    /// <summary>
    /// A texture of touch in a Unity project. The importer makes it from a .htex file.
    /// </summary>
    public sealed class HtexTexture : ScriptableObject
    {
        [SerializeField, HideInInspector] private byte[] bytes = new byte[0];
        [SerializeField] private string title = "";
        [SerializeField] private string quantity = "";
        [SerializeField] private string unit = "";
        [SerializeField] private string[] models = new string[0];
        [SerializeField] private Condition[] conditions = new Condition[0];

        /// <summary>The bytes of the .htex file. Do not change them.</summary>
        public byte[] Bytes { get { return bytes; } }
        /// <summary>The texture's name, which the file states.</summary>
        public string Title { get { return title; } }
        /// <summary>The physical quantity that was recorded, such as lateral_force.</summary>
        public string Quantity { get { return quantity; } }
        /// <summary>Unit of the samples.</summary>
        public string Unit { get { return unit; } }
        /// <summary>The model id of each representation.</summary>
        public string[] Models { get { return models; } }
        /// <summary>The recorded conditions.</summary>
        public Condition[] Conditions { get { return conditions; } }

        /// <summary>
        /// Makes the object from the bytes of a .htex file. If libhtex cannot open them, this
        /// throws HtexException with its error text.
        /// </summary>
        public static HtexTexture FromBytes(byte[] bytes)
        {
            using (var asset = Asset.FromBytes(bytes))
            {
                var texture = CreateInstance<HtexTexture>();
                texture.bytes = bytes;
                texture.title = asset.Name;
                texture.name = asset.Name;
                texture.quantity = JsonUtility.FromJson<Manifest>(asset.ManifestJson).quantity;
                texture.unit = asset.Unit;
                texture.models = asset.Models;
                texture.conditions = asset.Conditions;
                return texture;
            }
        }

        /// <summary>Opens the texture as an asset. Several voices may play one asset.</summary>
        public Asset Open(OpenOptions options = null)
        {
            return Asset.FromBytes(bytes, options);
        }

        /// <summary>The field of the manifest that no function of libhtex returns.</summary>
        [Serializable]
        private sealed class Manifest
        {
            public string quantity = "";
        }
    }
}
