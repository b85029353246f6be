// The few types of Unity that HtexNativeArray.cs uses.
using System;
using System.Runtime.InteropServices;

namespace Unity.Collections
{
    public struct NativeArray<T> : IDisposable where T : struct
    {
        internal IntPtr Address;
        public int Length { get; private set; }

        public NativeArray(int length)
        {
            Length = length;
            Address = Marshal.AllocHGlobal(4 * length);
        }

        public void Dispose()
        {
            Marshal.FreeHGlobal(Address);
        }
    }

    public static class Floats
    {
        public static void Clear(this NativeArray<float> array)
        {
            Marshal.Copy(new float[array.Length], 0, array.Address, array.Length);
        }

        public static void CopyTo(this NativeArray<float> array, float[] to, int offset)
        {
            Marshal.Copy(array.Address, to, offset, array.Length);
        }
    }
}

namespace Unity.Collections.LowLevel.Unsafe
{
    public static class NativeArrayUnsafeUtility
    {
        public static unsafe void* GetUnsafePtr<T>(NativeArray<T> array) where T : struct
        {
            return (void*)array.Address;
        }
    }
}
