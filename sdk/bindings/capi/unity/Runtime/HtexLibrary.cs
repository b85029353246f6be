// A .htexlib file as a Unity asset.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
using UnityEngine;

namespace Htex
{
    /// <summary>
    /// A library of textures in a Unity project. The importer makes it from a .htexlib file.
    /// </summary>
    public sealed class HtexLibrary : ScriptableObject
    {
        [SerializeField, HideInInspector] private byte[] bytes = new byte[0];
        [SerializeField] private string title = "";
        [SerializeField] private long count;

        /// <summary>The bytes of the .htexlib file. Do not change them.</summary>
        public byte[] Bytes { get { return bytes; } }
        /// <summary>The library's name, which the file states.</summary>
        public string Title { get { return title; } }
        /// <summary>Number of textures.</summary>
        public long Count { get { return count; } }

        /// <summary>
        /// Makes the object from the bytes of a .htexlib file. If libhtex cannot open them, this
        /// throws HtexException with its error text.
        /// </summary>
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

        /// <summary>
        /// Opens the library. Its textures are read one at a time, when they are opened.
        /// </summary>
        public Library Open()
        {
            return Library.FromBytes(bytes);
        }
    }
}
