// A .htex file as an asset of Unity. It holds the bytes, so it is played on systems that have no file for it, such as Android.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using System;
using UnityEngine;

namespace Htex
{
    /// <summary>A texture of touch in a project: what the importer of .htex files makes.</summary>
    public sealed class HtexTexture : ScriptableObject
    {
        [SerializeField, HideInInspector] private byte[] bytes = new byte[0];
        [SerializeField] private string title = "";
        [SerializeField] private string quantity = "";
        [SerializeField] private string unit = "";
        [SerializeField] private string[] models = new string[0];
        [SerializeField] private Condition[] conditions = new Condition[0];

        /// <summary>The file. Do not change it.</summary>
        public byte[] Bytes { get { return bytes; } }
        /// <summary>The name that the file states.</summary>
        public string Title { get { return title; } }
        /// <summary>What was recorded, such as lateral_force.</summary>
        public string Quantity { get { return quantity; } }
        /// <summary>Unit of the samples.</summary>
        public string Unit { get { return unit; } }
        /// <summary>Ids of the models of the representations.</summary>
        public string[] Models { get { return models; } }
        /// <summary>The recorded conditions.</summary>
        public Condition[] Conditions { get { return conditions; } }

        /// <summary>Makes it of a .htex file; throws HtexException with the text of libhtex for one that cannot be opened.</summary>
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

        /// <summary>Opens it. Several voices may play one asset.</summary>
        public Asset Open(OpenOptions options = null)
        {
            return Asset.FromBytes(bytes, options);
        }

        /// <summary>The part of a manifest that no call of libhtex returns.</summary>
        [Serializable]
        private sealed class Manifest
        {
            public string quantity = "";
        }
    }
}
