// Renders samples into Unity's NativeArrays without copying them.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#if UNITY_2021_2_OR_NEWER
using System;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;

namespace Htex
{
    /// <summary>Calls that render samples into a NativeArray.</summary>
    public static class HtexNativeArray
    {
        /// <summary>Renders the next samples, in the asset's unit.</summary>
        public static void Render(this Voice voice, NativeArray<float> samples)
        {
            voice.Render(Address(samples), samples.Length);
        }

        /// <summary>
        /// Renders the next samples, multiplies them by a gain and adds them to the array.
        /// </summary>
        public static void RenderAdd(this Voice voice, NativeArray<float> samples, float gain = 1.0f)
        {
            voice.RenderAdd(Address(samples), samples.Length, gain);
        }

        /// <summary>
        /// Renders the next samples of a scene and returns their number. At the end of the scene,
        /// the number is smaller than the array's length.
        /// </summary>
        public static int Render(this Scene scene, NativeArray<float> samples)
        {
            return scene.Render(Address(samples), samples.Length);
        }

        private static unsafe IntPtr Address(NativeArray<float> samples)
        {
            return (IntPtr)NativeArrayUnsafeUtility.GetUnsafePtr(samples);
        }
    }
}
#endif
