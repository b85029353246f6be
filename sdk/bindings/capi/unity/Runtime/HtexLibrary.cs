// A .htexlib file as an asset of Unity.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using UnityEngine;

namespace Htex
{
    /// <summary>A library of textures in a project: what the importer of .htexlib files makes.</summary>
    public sealed class HtexLibrary : ScriptableObject
    {
        [SerializeField, HideInInspector] private byte[] bytes = new byte[0];
        [SerializeField] private string title = "";
        [SerializeField] private long count;

        /// <summary>The file. Do not change it.</summary>
        public byte[] Bytes { get { return bytes; } }
        /// <summary>The name that the file states.</summary>
        public string Title { get { return title; } }
        /// <summary>Number of textures.</summary>
        public long Count { get { return count; } }

        /// <summary>Makes it of a .htexlib file; throws HtexException with the text of libhtex for one that cannot be opened.</summary>
        public static HtexLibrary FromBytes(byte[] bytes)
        {
            using (var opened = Library.FromBytes(bytes))
            {
                var library = CreateInstance<HtexLibrary>();
                library.bytes = bytes;
                library.title = opened.Name;
                library.name = opened.Name;
                library.count = (long)opened.Count;
                return library;
            }
        }

        /// <summary>Opens it; textures are read one by one.</summary>
        public Library Open()
        {
            return Library.FromBytes(bytes);
        }
    }
}
